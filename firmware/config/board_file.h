#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "core/cpu.h"
#include "core/parameter.h"
#include "hal/device_parameters.h"
#include "hal/mock/arena_parameters.h"

namespace touchline::config {

/// The version of the three files that this program reads and writes.
inline constexpr int kFileVersion = 1;
inline constexpr Range kVersionRange{kFileVersion, kFileVersion};

/// [scan] of the board file: how pixels become colors.
struct ScanSettings {
  KernelChoice kernel = KernelChoice::kFastest;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("kernel", self.kernel, std::span<const Choice<KernelChoice>>(kKernelChoices),
                 "By which of the processor's instructions; all find the same");
  }
};

/// [realtime] of the board file: what the loop asks of the kernel.
struct RealtimeSettings {
  int cpu = -1;
  int priority = 0;
  bool lock_memory = false;
  int wake_within_us = -1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("cpu", self.cpu, Range{-1, 1023}, "", "Processor that the loop is pinned to; -1: any");
    visit.number("priority", self.priority, Range{0, 99}, "",
                 "SCHED_FIFO priority of the loop; 0: ordinary scheduling");
    visit.flag("lock_memory", self.lock_memory,
               "Keep all memory in RAM (mlockall), so that no page fault delays a frame");
    visit.number("wake_within_us", self.wake_within_us, Range{-1, 10000}, "us",
                 "Longest time in which any processor may wake up (/dev/cpu_dma_latency); -1: as the system likes");
  }
};

/// [faults] of the board file: how long the loop bears with a fault.
struct FaultSettings {
  double stop_after_s = 0.2;
  double camera_timeout_s = 1.0;
  double reopen_after_s = 0.5;
  double leave_after_s = 0.0;
  bool resume_after_emergency = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("stop_after_s", self.stop_after_s, Range{0.02, 5.0}, "s",
                 "Robots are stopped when the last good frame is older");
    visit.number("camera_timeout_s", self.camera_timeout_s, Range{0.1, 60.0}, "s",
                 "A camera that gives no frame for so long is closed and opened again");
    visit.number("reopen_after_s", self.reopen_after_s, Range{0.01, 8.0}, "s",
                 "First pause before a lost device is opened again; doubles up to 8 s");
    visit.number("leave_after_s", self.leave_after_s, Range{0.0, 86400.0}, "s",
                 "The program gives up when a device stays away for so long; 0: never");
    visit.flag("resume_after_emergency", self.resume_after_emergency,
               "Robots move again when the emergency stop is released; else after the start button or a new start");
  }
};

/// board.toml (docs/files.md).
struct BoardFile {
  int version = kFileVersion;
  std::string name;
  std::string venue, team;  // relative to the board file
  hal::CameraSettings camera;
  hal::RadioSettings radio;
  hal::GpioSettings gpio;
  ScanSettings scan;
  RealtimeSettings realtime;
  FaultSettings faults;
  hal::mock::ArenaParameters arena;

  static constexpr std::array<std::string_view, 4> kRequired{"camera", "radio", "camera.backend", "radio.backend"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("version", self.version, kVersionRange, "", "Of this file's keys");
    visit.text("name", self.name, "What the board is called in reports");
    visit.text("venue", self.venue, "Venue file, relative to this file; --venue overrides it");
    visit.text("team", self.team, "Team file, relative to this file; --team overrides it");
    visit.section("camera", self.camera, "Where frames come from");
    visit.section("radio", self.radio, "The link to the robots");
    visit.section("gpio", self.gpio, "Lights, switches and buttons on lines of a chip");
    visit.section("scan", self.scan, "How pixels become colors");
    visit.section("realtime", self.realtime, "What the loop asks of the kernel; what is refused is reported once");
    visit.section("faults", self.faults, "How long the loop bears with a fault");
    visit.section("arena", self.arena, "What backend \"mock\" simulates");
  }
};

}  // namespace touchline::config
