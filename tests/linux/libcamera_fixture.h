#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "hal/linux/libcamera/libcamera_camera.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/linux/fake_dma.h"
#include "tests/linux/fake_kernel.h"
#include "tests/linux/fake_libcamera.h"
#include "tests/results.h"

namespace touchline::testing {

/// A board with a CSI camera and a DMA heap. At the end of each test all resources must be released. The clock is the
/// real one, because threads wait for each other; no result depends on how long they take.
class LibcameraTest : public ::testing::Test {
 protected:
  LibcameraTest() {
    kernel_.use_real_clock();
    kernel_.add("/dev/dma_heap/linux,cma", heap_);
  }
  void TearDown() override {
    camera_.reset();
    EXPECT_EQ(kernel_.open_files(), 0u);
    for (const auto& buffer : heap_.buffers()) {
      EXPECT_FALSE(buffer->mapped());
      EXPECT_TRUE(buffer->closed());
      EXPECT_EQ(buffer->violation(), "");
    }
    EXPECT_EQ(world_.violation, "");
    EXPECT_TRUE(world_.released);
  }

  static hal::CameraSettings settings() {
    hal::CameraSettings settings;
    settings.backend = hal::CameraBackend::kLibcamera;
    settings.device = "auto";
    settings.format = hal::CameraFormat::kNv12;
    settings.exposure_us = 0;  // a value would make every start report that the camera lacks the control
    settings.white_balance_k = 0;
    return settings;
  }
  void make(const hal::CameraSettings& requested) {
    camera_.emplace(requested, 0, std::make_unique<fake::FakeLibcamera>(world_));
  }
  void begin(const hal::CameraSettings& requested = settings()) {
    make(requested);
    ASSERT_OK(camera_->open());
    ASSERT_OK(camera_->start());
  }
  /// open() must fail with `code` and the message `reason`.
  void expect_refusal(const hal::CameraSettings& requested, ErrorCode code, const std::string& reason) {
    make(requested);
    expect_error(camera_->open(), code, reason);
  }
  /// Returns a time that is late enough for any machine; only failing tests wait for it.
  static Instant late() { return hal::MonotonicClock::read() + std::chrono::seconds(20); }
  /// The next frame must be lost with `code` and the message `reason`.
  void expect_loss(ErrorCode code, const std::string& reason) {
    const Result<hal::FrameLease> frame = camera_->wait(late());
    expect_error(frame, code, reason);
  }
  void expect_frame(std::uint32_t sequence) {
    const Result<hal::FrameLease> frame = camera_->wait(late());
    ASSERT_TRUE(frame.ok()) << frame.text();
    EXPECT_EQ(frame.value().frame().sequence, sequence);
    EXPECT_EQ(frame.value().frame().plane[0][0], static_cast<std::uint8_t>(sequence));
  }

  static constexpr const char* kId = "/base/soc/i2c0mux/i2c@1/imx219@10";
  fake::Kernel kernel_;
  fake::DmaHeapFile heap_;
  fake::LibcameraWorld world_;
  std::optional<hal::LibcameraCamera> camera_;
};

}  // namespace touchline::testing
