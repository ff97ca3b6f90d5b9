#include <atomic>
#include <cerrno>
#include <thread>
#include <vector>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/libcamera_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using hal::FrameLease;
using hal::LibcameraControl;
using hal::LibcameraFrame;
using hal::MonotonicClock;
using std::chrono::milliseconds;
using namespace std::chrono_literals;

class LibcameraStreamTest : public LibcameraTest {};

// The fake's caches show old pictures unless each read is announced.
TEST_F(LibcameraStreamTest, FramesArriveInOrderInTheDevicesMemory) {
  begin();
  for (std::uint32_t i = 1; i < 40; ++i) {
    world_.complete(i);
    expect_frame(i);
  }
  EXPECT_EQ(camera_->counters().frames, 39u);
  EXPECT_EQ(camera_->counters().lost, 0u);
}

TEST_F(LibcameraStreamTest, TheOldestFrameIsReturnedFirstAndALeaseKeepsItsBuffer) {
  begin();
  for (std::uint32_t i = 1; i <= 4; ++i) world_.complete(i);
  {
    const Result<FrameLease> first = camera_->wait(late());
    ASSERT_TRUE(first.ok());
    expect_frame(2);
    expect_frame(3);
    world_.wait_for_queued(2);
    world_.complete(5);
    world_.complete(6);
    EXPECT_EQ(first.value().frame().plane[0][0], 1);
    expect_frame(4);
  }
  world_.wait_for_queued(2);
  expect_frame(5);
  expect_frame(6);
  world_.wait_for_queued(4);
}

TEST_F(LibcameraStreamTest, NeitherWaitNorReleaseAllocates) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "a sanitizer has its own allocator";
  begin();
  std::uint64_t counted = 0;
  for (std::uint32_t i = 1; i < 20; ++i) {
    world_.complete(i, [&](LibcameraFrame& frame) { frame.bytes = i % 5 != 0 ? frame.bytes : 1; });
    const DriverAllocations allocations;
    {
      const Result<FrameLease> frame = camera_->wait(late());
      EXPECT_EQ(frame.ok(), i % 5 != 0);
    }
    EXPECT_EQ(camera_->wait(Instant{}).code(), ErrorCode::kTimeout);
    counted += allocations.count();
  }
  EXPECT_EQ(counted, 0u);
}

TEST_F(LibcameraStreamTest, WaitTimesOutAtTheDeadline) {
  begin();
  const Instant before = MonotonicClock::read();
  expect_error(camera_->wait(before + milliseconds(20)), ErrorCode::kTimeout,
               std::string(kId) + ": no frame before the deadline");
  EXPECT_GE(MonotonicClock::read() - before, milliseconds(20));
  world_.complete(1);
  expect_frame(1);
}

TEST_F(LibcameraStreamTest, DamagedAndShortFramesAreDroppedAndTheirBuffersRequeued) {
  begin();
  for (std::uint32_t i = 1; i < 30; i += 3) {
    world_.complete(i, [](LibcameraFrame& frame) { frame.state = LibcameraFrame::State::kDamaged; });
    expect_loss(ErrorCode::kCorruptFrame,
                std::string(kId) + ": libcamera marks frame " + std::to_string(i) + " as damaged");
    world_.complete(i + 1, [](LibcameraFrame& frame) { frame.bytes = 460799; });
    expect_loss(ErrorCode::kShortFrame,
                std::string(kId) + ": frame " + std::to_string(i + 1) + " has 460799 bytes instead of 460800");
    world_.complete(i + 2);
    expect_frame(i + 2);
  }
  EXPECT_EQ(camera_->counters().corrupt, 10u);
  EXPECT_EQ(camera_->counters().short_frames, 10u);
}

TEST_F(LibcameraStreamTest, AFailedCacheSynchronizationMakesADamagedFrame) {
  begin();
  world_.wait_for_queued(4);
  for (const auto& buffer : heap_.buffers()) buffer->fail_with = EIO;
  world_.complete(1);
  expect_loss(ErrorCode::kCorruptFrame, std::string(kId) + ": libcamera marks frame 1 as damaged");
}

TEST_F(LibcameraStreamTest, GapsInTheSequenceAreLostFrames) {
  begin();
  for (const std::uint32_t i : {10u, 11u, 14u}) {
    world_.complete(i);
    expect_frame(i);
  }
  EXPECT_EQ(camera_->counters().lost, 2u);
}

// A Raspberry Pi numbers the processed frames; frames that the sensor took in between show only in the time stamps.
TEST_F(LibcameraStreamTest, GapsInTimeAreLostFramesToo) {
  world_.metadata[LibcameraControl::kFrameDuration] = 10000.0;
  begin();
  const auto at = [](std::int64_t stamp_ms) {
    return [=](LibcameraFrame& frame) { frame.stamp_ns = stamp_ms * 1000000; };
  };
  world_.complete(5, at(100));
  expect_frame(5);
  world_.complete(6, at(109));  // a little early
  expect_frame(6);
  world_.complete(7, at(150));
  {
    const Result<FrameLease> frame = camera_->wait(late());
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(frame.value().frame().sequence, 10u);
  }
  EXPECT_EQ(camera_->counters().lost, 3u);
}

TEST_F(LibcameraStreamTest, AChangeOfTheRateOrAWrongStampIsNotAGap) {
  begin();
  std::uint32_t number = 0;
  const auto complete_frame = [&](std::int64_t stamp_ms, double duration_ms) {
    world_.complete(++number, [=](LibcameraFrame& frame) {
      frame.stamp_ns = stamp_ms * 1000000;
      frame.reported[LibcameraControl::kFrameDuration] = duration_ms * 1000.0;
    });
    EXPECT_TRUE(camera_->wait(late()).ok());
    return camera_->counters().lost;
  };
  EXPECT_EQ(complete_frame(100, 10.0), 0u);
  EXPECT_EQ(complete_frame(110, 40.0), 0u);
  EXPECT_EQ(complete_frame(150, 10.0), 0u) << "the previous frame took 40 ms";
  EXPECT_EQ(complete_frame(160, 10.0), 0u);
  EXPECT_EQ(complete_frame(200, 10.0), 3u) << "a real gap still counts";
  EXPECT_EQ(complete_frame(50, 10.0), 3u);
  EXPECT_EQ(complete_frame(220, 10.0), 3u) << "the wrong stamp is not the reference";
  const auto tomorrow = std::chrono::duration_cast<milliseconds>(MonotonicClock::read().time_since_epoch()) + 24h;
  EXPECT_EQ(complete_frame(tomorrow.count(), 10.0), 3u);
  EXPECT_EQ(complete_frame(240, 10.0), 3u);
  EXPECT_EQ(complete_frame(250, 10.0), 3u);
  EXPECT_EQ(complete_frame(280, 10.0), 5u);
}

TEST_F(LibcameraStreamTest, StampsAreTheMiddleOfTheExposure) {
  const auto captured_after_stamp = [&] {
    const std::int64_t stamp_ns = (MonotonicClock::read() - milliseconds(10)).time_since_epoch().count();
    world_.complete(1, [=](LibcameraFrame& frame) { frame.stamp_ns = stamp_ns; });
    const Result<FrameLease> frame = camera_->wait(late());
    EXPECT_TRUE(frame.ok());
    return frame.value().frame().capture_time.time_since_epoch().count() - stamp_ns;
  };
  // The first row of a CSI camera arrives when its exposure is over.
  world_.metadata[LibcameraControl::kExposure] = 4000.0;
  begin();
  EXPECT_EQ(captured_after_stamp(), -2000000);
  // The exposure time of a USB camera is known only from the board file.
  camera_.reset();
  world_.metadata = {};
  world_.cameras[0].external = true;
  world_.limits.low[LibcameraControl::kExposure] = 100.0;
  world_.limits.high[LibcameraControl::kExposure] = 100000.0;
  hal::CameraSettings requested = settings();
  requested.exposure_us = 5000;
  begin(requested);
  EXPECT_EQ(captured_after_stamp(), hal::uvc_computes_stamps() ? 2500000 : -2500000);
}

TEST_F(LibcameraStreamTest, AnUnpluggedCameraEndsTheWaitAndIsReopenedById) {
  begin();
  const std::vector<hal::LibcameraName> cameras = world_.cameras;
  std::thread unplugger([&] {
    std::this_thread::sleep_for(milliseconds(10));
    world_.unplug();
  });
  const std::string gone = std::string(kId) + ": the camera went away (reported by libcamera)";
  expect_loss(ErrorCode::kDisconnected, gone);
  unplugger.join();
  expect_loss(ErrorCode::kDisconnected, gone);  // until it is reopened
  camera_->stop();
  camera_->close();
  EXPECT_EQ(camera_->open().code(), ErrorCode::kNotFound);
  world_.cameras = cameras;
  ASSERT_OK(camera_->open());
  ASSERT_OK(camera_->start());
  world_.complete(1);
  expect_frame(1);
  camera_->stop();
  world_.unplug();
  EXPECT_EQ(camera_->start().code(), ErrorCode::kDisconnected);
}

TEST_F(LibcameraStreamTest, ACanceledFrameRequiresReopening) {
  begin();
  world_.complete(1, [](LibcameraFrame& frame) { frame.state = LibcameraFrame::State::kCancelled; });
  expect_loss(ErrorCode::kIo, std::string(kId) + ": libcamera canceled a frame in progress");
  EXPECT_EQ(camera_->wait(late()).code(), ErrorCode::kIo);
}

TEST_F(LibcameraStreamTest, AFailedRequestIsReportedByTheNextWait) {
  begin();
  world_.wait_for_queued(4);
  world_.complete(1);
  world_.errors = {{"queue", EIO}};
  expect_frame(1);
  expect_loss(ErrorCode::kIo, std::string(kId) + ": queuing a request failed: Input/output error");
}

TEST_F(LibcameraStreamTest, StopDropsFramesInProgress) {
  begin();
  world_.complete(1);
  world_.complete(2);
  camera_->stop();
  EXPECT_EQ(camera_->wait(late()).code(), ErrorCode::kInconsistent);
  ASSERT_OK(camera_->start());
  ASSERT_TRUE(camera_->start().ok());  // no effect
  world_.complete(8);
  expect_frame(8);
  EXPECT_EQ(camera_->counters().lost, 0u);
}

TEST_F(LibcameraStreamTest, AFailedStartLeavesNoFrameForTheNextStart) {
  world_.frames_at_start = 2;
  world_.good_queues = 2;
  world_.errors = {{"queue", EIO}};
  make(settings());
  ASSERT_OK(camera_->open());
  EXPECT_EQ(camera_->start().code(), ErrorCode::kIo);
  world_.frames_at_start = 1;
  ASSERT_OK(camera_->start());
  world_.wait_for_queued(4);
  world_.complete(1);
  expect_frame(1);
}

// Colors were calibrated with these controls, so frames taken before they took effect are useless.
TEST_F(LibcameraStreamTest, StartSkipsFramesTakenBeforeTheControlsTookEffect) {
  world_.limits.low[LibcameraControl::kExposure] = 100.0;
  world_.limits.high[LibcameraControl::kExposure] = 100000.0;
  world_.frames_at_start = 20;
  world_.early_frames = 3;
  world_.early_metadata[LibcameraControl::kExposure] = 20000.0;
  world_.metadata[LibcameraControl::kExposure] = 4980.0;  // whole rows
  world_.metadata[LibcameraControl::kFrameDuration] = 1e6 / 30.0;
  hal::CameraSettings requested = settings();
  requested.exposure_us = 5000;
  requested.rate_hz = 30.0;
  begin(requested);
  EXPECT_EQ(camera_->info().negotiated, std::string(kId) + ": rate_hz = 30: the camera does not report its frame rate");
  EXPECT_EQ(world_.early_frames, 0);
  EXPECT_DOUBLE_EQ(camera_->info().rate_hz, 30.0);
  EXPECT_EQ(camera_->info().description, std::string(kId) +
                                             " (imx219): nv12 640x480 at 30 Hz, 4 buffers of /dev/dma_heap/linux,cma, "
                                             "exposure 4980 us");
  world_.early_frames = 20;  // the controls never take effect: that is reported, and the camera streams
  camera_->stop();
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_NE(camera_->info().negotiated.find("exposure_us = 5000: set to 20000 (range 100 to 100000)"),
            std::string::npos)
      << camera_->info().negotiated;
}

TEST_F(LibcameraStreamTest, AStartWithoutFramesReportsThatTheValuesAreUnknown) {
  world_.limits.low[hal::LibcameraControl::kExposure] = 75.0;
  world_.limits.high[hal::LibcameraControl::kExposure] = 4000.0;
  world_.limits.low[hal::LibcameraControl::kFrameDuration] = 10000.0;
  world_.limits.high[hal::LibcameraControl::kFrameDuration] = 100000.0;
  world_.frames_at_start = 0;
  hal::CameraSettings requested = settings();
  requested.exposure_us = 5000;
  make(requested);
  ASSERT_OK(camera_->open());
  std::thread unplugger([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    world_.unplug();  // otherwise start() waits for two seconds
  });
  EXPECT_TRUE(camera_->start().ok());
  unplugger.join();
  EXPECT_EQ(camera_->info().negotiated, std::string(kId) +
                                            ": exposure_us = 5000: set to 4000 (range 75 to 4000); no frame arrived "
                                            "yet, so the actual values are unknown");
}

TEST_F(LibcameraStreamTest, ThreadsAtFullSpeedLoseNoFrame) {
  hal::CameraSettings small = settings();
  small.width_px = 64;
  small.height_px = 48;
  begin(small);
  constexpr std::uint32_t kFrames = 2000;
  std::thread sensor([&] {
    for (std::uint32_t i = 1; i <= kFrames; ++i) world_.complete(i);
  });
  for (std::uint32_t i = 1; i <= kFrames; ++i) expect_frame(i);
  sensor.join();
  EXPECT_EQ(camera_->counters().frames, kFrames);
}

}  // namespace
}  // namespace touchline::testing
