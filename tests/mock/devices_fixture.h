#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "hal/mock/arena.h"
#include "hal/mock/mock_devices.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {

/// The three mock devices with their own arena and its virtual time. Pictures are small, so that tests are fast.
class DevicesTest : public ::testing::Test {
 protected:
  DevicesTest() {
    settings.width_px = 64;
    settings.height_px = 48;
    settings.format = CameraFormat::kRgb24;
    settings.rate_hz = 50.0;
    parameters.camera.focal_px = 56.0;
    parameters.camera.center_u_px = 32.0;
    parameters.camera.center_v_px = 24.0;
  }

  /// Makes all devices, opens them and starts the camera.
  void start() {
    arena.emplace(parameters, settings, radio_settings, 1);
    clock = std::make_unique<ArenaClock>(*arena);
    camera.emplace(*arena, *clock);
    radio.emplace(*arena, *clock);
    gpio.emplace(*arena, *clock);
    ASSERT_TRUE(camera->open().ok());
    ASSERT_TRUE(camera->start().ok());
    ASSERT_TRUE(radio->open().ok());
    ASSERT_TRUE(gpio->open().ok());
  }
  [[nodiscard]] double now_s() const { return seconds(arena->now() - Arena::kBegin); }
  void go_to(double at_s) { arena->advance_to(Arena::kBegin + from_seconds(at_s)); }
  Result<FrameLease> wait(double for_s = 1.0) { return camera->wait(arena->now() + from_seconds(for_s)); }
  /// Discards the frames that are in memory.
  void skip_frames() {
    while (wait(0.0).ok()) {
    }
  }
  void add_fault(FaultKind kind, double at_s, double for_s) { parameters.fault.push_back({kind, at_s, for_s}); }

  ArenaParameters parameters = noise_free_arena();
  CameraSettings settings;
  RadioSettings radio_settings;
  std::optional<Arena> arena;
  std::unique_ptr<Clock> clock;
  std::optional<MockCamera> camera;
  std::optional<MockRadio> radio;
  std::optional<MockGpio> gpio;
};

}  // namespace touchline::hal::mock
