// Exposure, gain and the like while it streams.
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
      world_.told[control] = now;
    };
    add(kExposure, 75.0, 100000.0, 5000.0);
    add(kGain, 1.0, 10.6, 2.5);
  }
  static hal::CameraSettings asked(int exposure_us, int gain) {
    hal::CameraSettings asked = settings();
    asked.exposure_us = exposure_us;
    asked.gain = gain;
    return asked;
  }
  /// On a thread of its own, while frames come and are taken. Returns what differs from the settings; `frames`: how
  /// many came.
  std::string adjust(const hal::CameraSettings& settings, std::uint32_t& frames) {
    std::string negotiated = "?";
    std::atomic<bool> done{false};
    std::thread person([&] {
      negotiated = camera_->adjust(settings).value();
      done = true;
    });
    for (frames = 0; !done; ++frames) come();
    person.join();
    return negotiated;
  }
  void come() {
    std::this_thread::sleep_for(pause_);
    world_.complete(++number_);
    expect_frame(number_);
  }
  std::uint32_t number_ = 0;
  std::chrono::milliseconds pause_{0};
};

TEST_F(LibcameraAdjustTest, GoesWithTheNextRequestAndNoFrameIsLost) {
  begin(asked(5000, 250));
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(asked(4000, 300), frames), "");
  EXPECT_EQ(world_.adjustments, 1);
  EXPECT_EQ(world_.told[kExposure], 4000.0);
  EXPECT_EQ(world_.told[kGain], 3.0);
  EXPECT_EQ(camera_->counters().lost, 0u);
  EXPECT_EQ(adjust(asked(0, 300), frames), "");
  for (int i = 0; i < 8; ++i) come();  // those queued before
  EXPECT_EQ(world_.adjustments, 2);
  EXPECT_EQ(world_.controls[kExposure], 4000.0) << "0 leaves it as it is";
  EXPECT_EQ(camera_->counters().lost, 0u);
  camera_->stop();
  camera_->close();
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_EQ(world_.controls[kGain], 3.0) << "also after the next opening";
  EXPECT_FALSE(world_.controls[kExposure]) << "which leaves it to the camera";
}

TEST_F(LibcameraAdjustTest, WhatIsGrantedOtherwiseIsTold) {
  begin(asked(5000, 250));
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(asked(5000, 2000), frames), std::string(kId) + ": gain = 2000: set to 1060 (range 100 to 1060)");
  world_.obeys = false;
  EXPECT_EQ(adjust(asked(8000, 300), frames), std::string(kId) +
                                                  ": exposure_us = 8000: set to 5000 (range 75 to 100000); "
                                                  "gain = 300: set to 1060 (range 100 to 1060)");
  EXPECT_GE(frames, 14u) << "no earlier is it certain that it will not come";
}

TEST_F(LibcameraAdjustTest, WaitsForTheRequestBehindAllOthers) {
  hal::CameraSettings many = asked(5000, 250);
  many.buffers = 32;
  begin(many);
  many.exposure_us = 3000;
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(many, frames), "");
  EXPECT_GE(frames, 31u);
}

TEST_F(LibcameraAdjustTest, WaitsAsLongAsFramesCome) {
  hal::CameraSettings slow = asked(5000, 250);
  slow.rate_hz = 10.0;
  begin(slow);
  pause_ = std::chrono::milliseconds(80);  // in sum, more than one frame is waited for
  slow.exposure_us = 3000;
  std::uint32_t frames = 0;
  world_.obeys = false;
  EXPECT_EQ(adjust(slow, frames), std::string(kId) + ": exposure_us = 3000: set to 5000 (range 75 to 100000)");
  EXPECT_GE(frames, 14u);
}

TEST_F(LibcameraAdjustTest, AStalledCameraTellsNothing) {
  begin(asked(5000, 250));
  const std::string no_frame = std::string(kId) + ": set, but no frame came to tell what is in force";
  EXPECT_EQ(camera_->adjust(asked(4000, 250)).value(), no_frame);
  std::string negotiated;
  std::thread person([&] { negotiated = camera_->adjust(asked(3000, 250)).value(); });
  come();
  person.join();
  EXPECT_EQ(negotiated, no_frame) << "that one was taken before";
}

TEST_F(LibcameraAdjustTest, ACameraThatDoesNotTellItBackIsBelieved) {
  world_.told = {};
  world_.cameras[0].external = true;
  begin(asked(5000, 0));
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(asked(8000, 0), frames),
            std::string(kId) + ": exposure_us = 8000: set, but the camera does not tell it back");
  // Later than the frames before by more than the new exposure moves it back.
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const Instant stamp = hal::MonotonicClock::read();
  world_.complete(++number_, [&](hal::LibcameraFrame& frame) { frame.stamp_ns = stamp.time_since_epoch().count(); });
  const Result<hal::FrameLease> frame = camera_->wait(late());
  ASSERT_TRUE(frame.ok());
  const auto half = std::chrono::milliseconds(hal::uvc_computes_stamps() ? 4 : -4);
  EXPECT_EQ(frame.value().frame().capture_time - stamp, half);
}

TEST_F(LibcameraAdjustTest, WhatTheCameraLacksIsTold) {
  begin(asked(5000, 250));
  hal::CameraSettings more = asked(5000, 250);
  more.focus = 100;
  std::uint32_t frames = 0;
  EXPECT_EQ(adjust(more, frames), std::string(kId) + ": focus = 100: the camera has no such control");
}

TEST_F(LibcameraAdjustTest, BeforeItStreamsTheStartTakesItOver) {
  make(asked(5000, 250));
  EXPECT_EQ(camera_->adjust(asked(4000, 250)).value(), "");
  ASSERT_TRUE(camera_->open().ok());
  EXPECT_TRUE(camera_->adjust(asked(4000, 300)).ok());
  world_.told[kExposure] = 4000.0;
  world_.told[kGain] = 3.0;
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_EQ(world_.controls[kExposure], 4000.0);
  EXPECT_EQ(world_.controls[kGain], 3.0);
}

}  // namespace
}  // namespace touchline::testing
