#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "core/cpu.h"
#include "core/parameter.h"
#include "firmware/config/console_settings.h"
#include "firmware/config/network_settings.h"
#include "firmware/config/recording_settings.h"
#include "hal/device_parameters.h"
#include "hal/mock/arena_parameters.h"

namespace touchline::config {

/// Version of the file format that this program reads and writes.
inline constexpr int kFileVersion = 1;
inline constexpr Range kVersionRange{kFileVersion, kFileVersion};

/// [scan] of the board file: color classification.
struct ScanSettings {
  KernelChoice kernel = KernelChoice::kFastest;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.kernel, kKernelChoices,
                 {.name = "kernel", .help = "Instruction set of the color classification; all give the same result"});
  }
};

/// [realtime] of the board file: real-time settings of the loop.
struct RealtimeSettings {
  int cpu = -1;
  int priority = 0;
  bool lock_memory = false;
  int wake_within_us = -1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.cpu, {.name = "cpu", .range = {-1, 1023}, .help = "CPU that the loop is pinned to; -1: any"});
    visit.number(
        self.priority,
        {.name = "priority", .range = {0, 99}, .help = "SCHED_FIFO priority of the loop; 0: normal scheduling"});
    visit.flag(self.lock_memory,
               {.name = "lock_memory", .help = "Lock all memory in RAM (mlockall): no page fault delays a frame"});
    visit.number(self.wake_within_us, {.name = "wake_within_us",
                                       .range = {-1, 10000},
                                       .unit = "us",
                                       .help = "Maximum wake-up latency of all CPUs (/dev/cpu_dma_latency): 10 forbids "
                                               "deep idle states, 0 keeps them spinning; -1: not set"});
  }
};

/// [faults] of the board file: time limits after a fault.
struct FaultSettings {
  double stop_after_s = 0.2;
  // The default takes less time than stop_after_s at the rates of the leagues (30 to 90 Hz), because an unusable frame
  // gives no more information than a missing one. Single unusable frames happen in a game, when a hand or a flash
  // covers the field.
  int unusable_frames = 5;
  double camera_timeout_s = 1.0;
  double reopen_after_s = 0.5;
  double leave_after_s = 0.0;
  double referee_timeout_s = 1.0;
  // If a cable is plugged in again at once, the radio works again within this time: the first attempt to reopen it
  // follows after 0.5 s and takes some tenths of a second.
  double radio_outage_s = 1.0;
  bool resume_after_emergency = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.stop_after_s, {.name = "stop_after_s",
                                     .range = {0.02, 5.0},
                                     .unit = "s",
                                     .help = "Age of the last good frame, or of a picture that the camera repeats, "
                                             "after which robots are stopped"});
    visit.number(self.unusable_frames,
                 {.name = "unusable_frames",
                  .range = {1, 1000},
                  .help = "Number of frames with overload, or without a recognizable field, after which robots are "
                          "stopped, and of others after which they move again"});
    visit.number(self.camera_timeout_s, {.name = "camera_timeout_s",
                                         .range = {0.1, 60.0},
                                         .unit = "s",
                                         .help = "Time without a frame after which the camera is closed and reopened"});
    visit.number(self.reopen_after_s, {.name = "reopen_after_s",
                                       .range = {0.01, 8.0},
                                       .unit = "s",
                                       .help = "First pause before a lost device is reopened; it doubles up to 8 s, or "
                                               "up to 2 s while the device is absent"});
    visit.number(self.leave_after_s, {.name = "leave_after_s",
                                      .range = {0.0, 86400.0},
                                      .unit = "s",
                                      .help = "Time without a device after which the program exits; 0: never"});
    visit.number(self.referee_timeout_s,
                 {.name = "referee_timeout_s",
                  .range = {0.2, 60.0},
                  .unit = "s",
                  .help = "Time without a message, of a referee that repeats them, after which robots are stopped"});
    visit.number(self.radio_outage_s, {.name = "radio_outage_s",
                                       .range = {0.0, 3600.0},
                                       .unit = "s",
                                       .help = "Longest outage of the radio after which robots go on by themselves; "
                                               "after a longer one they wait for a start"});
    visit.flag(self.resume_after_emergency, {.name = "resume_after_emergency",
                                             .help = "Robots move again when the emergency stop is released; false: "
                                                     "only after a start (start button, Start of the page, restart)"});
  }
};

/// board.toml (docs/files.md).
struct BoardFile {
  int version = kFileVersion;
  std::string name;
  std::string venue, team;  // paths relative to the board file
  hal::CameraSettings camera;
  hal::RadioSettings radio;
  hal::GpioSettings gpio;
  ScanSettings scan;
  RealtimeSettings realtime;
  FaultSettings faults;
  NetworkSettings network;
  ConsoleSettings console;
  RecordingSettings recording;
  hal::mock::ArenaParameters arena;

  static constexpr std::array<std::string_view, 7> kRequired{"camera",
                                                             "radio",
                                                             "camera.backend",
                                                             "radio.backend",
                                                             "radio.more.backend",
                                                             "network.output.protocol",
                                                             "network.input.protocol"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.version, {.name = "version", .range = kVersionRange, .help = "Version of the file format"});
    visit.text(self.name, {.name = "name", .reload = Reload::kNoEffect, .help = "Name of the board in reports"});
    visit.text(self.venue, {.name = "venue",
                            .reload = Reload::kNoEffect,
                            .help = "Venue file, relative to this file; --venue overrides it"});
    visit.text(
        self.team,
        {.name = "team", .reload = Reload::kNoEffect, .help = "Team file, relative to this file; --team overrides it"});
    visit.section(self.camera, {.name = "camera", .help = "The camera"});
    visit.section(self.radio, {.name = "radio", .help = "The radio link to the robots"});
    visit.section(self.gpio, {.name = "gpio", .help = "Lamps, switches and buttons on GPIO lines (docs/gpio.md)"});
    visit.section(self.scan, {.name = "scan", .help = "Color classification"});
    visit.section(self.realtime,
                  {.name = "realtime",
                   .help = "Real-time settings of the loop; settings that the system refuses are reported once"});
    visit.section(self.faults, {.name = "faults", .reload = Reload::kLoop, .help = "Time limits after a fault"});
    visit.section(self.network, {.name = "network", .help = "Connections to other programs (docs/network.md)"});
    visit.section(self.console, {.name = "console", .help = "The page in a browser (docs/console-protocol.md)"});
    visit.section(self.recording, {.name = "recording", .help = "Recordings of games (docs/recordings.md)"});
    visit.section(self.arena, {.name = "arena", .help = "Simulation of the backend \"mock\" (docs/arena.md)"});
  }
};

}  // namespace touchline::config
