#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "hal/linux/v4l2/v4l2_camera.h"
#include "tests/linux/fake_kernel.h"
#include "tests/linux/fake_v4l2.h"
#include "tests/results.h"

namespace touchline::testing {

/// A machine with one camera at /dev/video0. At the end of each test all resources must be released.
class V4l2Test : public ::testing::Test {
 protected:
  V4l2Test() { kernel_.add("/dev/video0", device_); }
  void TearDown() override {
    EXPECT_EQ(kernel_.open_files(), 0u);
    EXPECT_EQ(device_.mapped(), 0u);
    EXPECT_EQ(device_.violations(), std::vector<std::string>{});
  }

  static hal::CameraSettings settings() {
    hal::CameraSettings settings;
    settings.backend = hal::CameraBackend::kV4l2;
    return settings;
  }
  /// Returns the report of adjust(), which must succeed.
  static std::string negotiated_by(const Result<std::string>& adjusted) {
    EXPECT_TRUE(adjusted.ok()) << adjusted.text();
    return adjusted.ok() ? adjusted.value() : "";
  }
  [[nodiscard]] Instant soon() const { return kernel_.now() + std::chrono::milliseconds(100); }
  /// open() must fail with `code` and the message `reason`.
  void expect_refusal(const hal::CameraSettings& settings, ErrorCode code, const std::string& reason) {
    hal::V4l2Camera camera(settings);
    expect_error(camera.open(), code, reason);
  }
  /// open() must succeed and report `negotiated`.
  void expect_negotiated(const hal::CameraSettings& settings, const std::string& negotiated) {
    hal::V4l2Camera camera(settings);
    EXPECT_TRUE(camera.open().ok());
    EXPECT_EQ(camera.info().negotiated, negotiated);
  }
  /// The next frame must be lost with `code` and the message `reason`.
  void expect_loss(hal::V4l2Camera& camera, ErrorCode code, const std::string& reason) {
    const Result<hal::FrameLease> frame = camera.wait(soon());
    expect_error(frame, code, reason);
  }
  /// The next frame must be good and have this number.
  void expect_frame(hal::V4l2Camera& camera, std::uint32_t sequence) {
    const Result<hal::FrameLease> frame = camera.wait(soon());
    ASSERT_TRUE(frame.ok()) << frame.text();
    EXPECT_EQ(frame.value().frame().sequence, sequence);
  }

  fake::Kernel kernel_;
  fake::VideoDevice device_;
};

/// Fixture with a camera that streams after begin().
class V4l2RunningTest : public V4l2Test {
 protected:
  void begin(const hal::CameraSettings& requested = settings()) {
    camera_.emplace(requested);
    ASSERT_OK(camera_->open());
    ASSERT_OK(camera_->start());
  }
  void TearDown() override {
    camera_.reset();
    V4l2Test::TearDown();
  }

  std::optional<hal::V4l2Camera> camera_;
};

}  // namespace touchline::testing
