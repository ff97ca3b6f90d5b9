// Changes of exposure and gain while the camera streams.
#include <atomic>
#include <thread>

#include "tests/linux/libcamera_fixture.h"

namespace touchline::testing {
namespace {

using enum hal::LibcameraControl;

class LibcameraAdjustTest : public LibcameraTest {
 protected:
  LibcameraAdjustTest() {
    const auto add = [&](hal::LibcameraControl control, double low, double high, double now) {
      world_.limits.low[control] = low;
      world_.limits.high[control] = high;
      world_.metadata[control] = now;
    };
    add(kExposure, 75.0, 100000.0, 5000.0);
    add(kGain, 1.0, 10.6, 2.5);
  }
  static hal::CameraSettings requested(int exposure_us, int gain) {
    hal::CameraSettings requested = settings();
    requested.exposure_us = exposure_us;
    requested.gain = gain;
    return requested;
  }
  /// Calls adjust() on another thread while frames arrive. Returns the differences from the settings; `frames`: the
  /// number of frames that arrived.
  std::string adjust(const hal::CameraSettings& settings, std::uint32_t& frames) {
    std::string negotiated = "?";
    std::atomic<bool> done{false};
    std::thread adjuster([&] {
      negotiated = camera_->adjust(settings).value();
      done = true;
    });
    for (frames = 0; !done; ++frames) complete_frame();
    adjuster.join();
    return negotiated;
  }
  void complete_frame() {
    std::this_thread::sleep_for(pause_);
    world_.complete(++number_);
    expect_frame(number_);
  }
  std::uint32_t number_ = 0;
  std::chrono::milliseconds pause_{0};
};

TEST_F(LibcameraAdjustTest, ControlsAreSentWithTheNextRequestAndNoFrameIsLost) {
  begin(requested(5000, 250));
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(requested(4000, 300), frames), "");
  EXPECT_EQ(world_.adjustments, 1);
  EXPECT_EQ(world_.metadata[kExposure], 4000.0);
  EXPECT_EQ(world_.metadata[kGain], 3.0);
  EXPECT_EQ(camera_->counters().lost, 0u);
  EXPECT_EQ(adjust(requested(0, 300), frames), "");
  for (int i = 0; i < 8; ++i) complete_frame();  // the frames that were queued before
  EXPECT_EQ(world_.adjustments, 2);
  EXPECT_EQ(world_.controls[kExposure], 4000.0) << "0 does not change it";
  EXPECT_EQ(camera_->counters().lost, 0u);
  camera_->stop();
  camera_->close();
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_EQ(world_.controls[kGain], 3.0) << "also after reopening";
  EXPECT_FALSE(world_.controls[kExposure]) << "not set, so the camera decides";
}

TEST_F(LibcameraAdjustTest, DifferencesFromTheSettingsAreReported) {
  begin(requested(5000, 250));
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(requested(5000, 2000), frames), std::string(kId) + ": gain = 2000: set to 1060 (range 100 to 1060)");
  world_.applies_controls = false;
  EXPECT_EQ(adjust(requested(8000, 300), frames), std::string(kId) +
                                                      ": exposure_us = 8000: set to 5000 (range 75 to 100000); "
                                                      "gain = 300: set to 1060 (range 100 to 1060)");
  EXPECT_GE(frames, 14u) << "only after this many frames is it certain that the change has no effect";
}

TEST_F(LibcameraAdjustTest, WaitsForTheRequestAfterAllQueuedOnes) {
  hal::CameraSettings many = requested(5000, 250);
  many.buffers = 32;
  begin(many);
  many.exposure_us = 3000;
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(many, frames), "");
  EXPECT_GE(frames, 31u);
}

TEST_F(LibcameraAdjustTest, WaitsWhileFramesArrive) {
  hal::CameraSettings slow = requested(5000, 250);
  slow.rate_hz = 10.0;
  begin(slow);
  pause_ = std::chrono::milliseconds(80);  // in total longer than the timeout of one frame
  slow.exposure_us = 3000;
  std::uint32_t frames = 0;
  world_.applies_controls = false;
  EXPECT_EQ(adjust(slow, frames), std::string(kId) + ": exposure_us = 3000: set to 5000 (range 75 to 100000)");
  EXPECT_GE(frames, 14u);
}

TEST_F(LibcameraAdjustTest, AStalledCameraIsReported) {
  begin(requested(5000, 250));
  const std::string no_frame = std::string(kId) + ": set, but no frame arrived to confirm it";
  EXPECT_EQ(camera_->adjust(requested(4000, 250)).value(), no_frame);
  std::string negotiated;
  std::thread adjuster([&] { negotiated = camera_->adjust(requested(3000, 250)).value(); });
  complete_frame();
  adjuster.join();
  EXPECT_EQ(negotiated, no_frame) << "that frame was taken before the change";
}

TEST_F(LibcameraAdjustTest, ControlsThatTheCameraDoesNotReportAreAssumedToBeSet) {
  world_.metadata = {};
  world_.cameras[0].external = true;
  begin(requested(5000, 0));
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(requested(8000, 0), frames),
            std::string(kId) + ": exposure_us = 8000: set, but the camera does not report it");
  // The stamp, moved back by half the new exposure, must still be later than the previous ones.
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const Instant stamp = hal::MonotonicClock::read();
  world_.complete(++number_, [&](hal::LibcameraFrame& frame) { frame.stamp_ns = stamp.time_since_epoch().count(); });
  const Result<hal::FrameLease> frame = camera_->wait(late());
  ASSERT_TRUE(frame.ok());
  const auto half = std::chrono::milliseconds(hal::uvc_computes_stamps() ? 4 : -4);
  EXPECT_EQ(frame.value().frame().capture_time - stamp, half);
}

TEST_F(LibcameraAdjustTest, MissingControlsAreReported) {
  begin(requested(5000, 250));
  hal::CameraSettings more = requested(5000, 250);
  more.focus = 100;
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(more, frames), std::string(kId) + ": focus = 100: the camera has no such control");
}

TEST_F(LibcameraAdjustTest, ChangesBeforeTheStartAreAppliedAtTheStart) {
  make(requested(5000, 250));
  EXPECT_EQ(camera_->adjust(requested(4000, 250)).value(), "");
  ASSERT_TRUE(camera_->open().ok());
  EXPECT_TRUE(camera_->adjust(requested(4000, 300)).ok());
  world_.metadata[kExposure] = 4000.0;
  world_.metadata[kGain] = 3.0;
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_EQ(world_.controls[kExposure], 4000.0);
  EXPECT_EQ(world_.controls[kGain], 3.0);
}

}  // namespace
}  // namespace touchline::testing
