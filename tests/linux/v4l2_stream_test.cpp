#include <array>
#include <cstring>
#include <vector>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/v4l2_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using hal::CameraFormat;
using hal::CameraSettings;
using hal::FrameLease;
using hal::V4l2Camera;

constexpr Duration kExposureTime = std::chrono::milliseconds(5);
constexpr Duration kMicrosecond = std::chrono::microseconds(1);  // the resolution of V4L2's time stamps

class V4l2StreamTest : public V4l2RunningTest {
 protected:
  static CameraSettings small(CameraFormat format) {
    CameraSettings requested = settings();
    requested.format = format;
    requested.width_px = 320;
    requested.height_px = 240;
    return requested;
  }
};

std::uint32_t number_in(const Frame& frame) {
  std::uint32_t number = 0;
  std::memcpy(&number, frame.plane[0], sizeof number);
  return number;
}

TEST_F(V4l2StreamTest, PlanesAndStridesAreSetForAllFormats) {
  struct Case {
    CameraFormat format;
    std::uint32_t fourcc, bytes_per_pixel;
  };
  constexpr std::array<Case, 8> kCases{{{CameraFormat::kRgb24, V4L2_PIX_FMT_RGB24, 3},
                                        {CameraFormat::kBgr24, V4L2_PIX_FMT_BGR24, 3},
                                        {CameraFormat::kYuyv, V4L2_PIX_FMT_YUYV, 2},
                                        {CameraFormat::kUyvy, V4L2_PIX_FMT_UYVY, 2},
                                        {CameraFormat::kNv12, V4L2_PIX_FMT_NV12, 1},
                                        {CameraFormat::kI420, V4L2_PIX_FMT_YUV420, 1},
                                        {CameraFormat::kXrgb8888, V4L2_PIX_FMT_XBGR32, 4},
                                        {CameraFormat::kYuvj422p, V4L2_PIX_FMT_YUV422P, 1}}};
  device_.padding_bytes = 24;
  for (const unsigned interface : {V4L2_CAP_VIDEO_CAPTURE + 0u, V4L2_CAP_VIDEO_CAPTURE_MPLANE + 0u}) {
    device_.capabilities = interface | V4L2_CAP_STREAMING;
    for (const Case& c : kCases) {
      device_.formats = {{c.fourcc, {{320, 240}}, false}};
      begin(small(c.format));
      const Result<FrameLease> result = camera_->wait(soon());
      ASSERT_TRUE(result.ok()) << result.text();
      const Frame& frame = result.value().frame();
      EXPECT_EQ(frame.format, hal::pixel_format(c.format));
      EXPECT_EQ(frame.stride_bytes[0], 320 * c.bytes_per_pixel + 24);
      if (c.format == CameraFormat::kNv12) {
        EXPECT_EQ(frame.plane[1], frame.plane[0] + std::size_t{344} * 240);
        EXPECT_EQ(frame.stride_bytes[1], 344u);
        EXPECT_EQ(frame.plane[2], nullptr);
      } else if (c.format == CameraFormat::kI420) {
        EXPECT_EQ(frame.plane[1], frame.plane[0] + std::size_t{344} * 240);
        EXPECT_EQ(frame.plane[2], frame.plane[1] + std::size_t{172} * 120);
        EXPECT_EQ(frame.stride_bytes[1], 172u);
        EXPECT_EQ(frame.stride_bytes[2], 172u);
      } else if (c.format == CameraFormat::kYuvj422p) {
        EXPECT_EQ(frame.plane[2], frame.plane[1] + std::size_t{172} * 240);
        EXPECT_EQ(frame.stride_bytes[2], 172u);
      } else {
        EXPECT_EQ(frame.plane[1], nullptr);
      }
    }
  }
}

TEST_F(V4l2StreamTest, TheLastRowMayLackItsPadding) {
  device_.padding_bytes = 64;
  device_.frame_faults[0].bytes = 1344 * 479 + 1280;
  device_.frame_faults[1].bytes = 1344 * 479 + 1279;
  begin(settings());
  expect_frame(*camera_, 0);
  expect_loss(*camera_, ErrorCode::kShortFrame, "/dev/video0: frame 1 has 645055 bytes instead of 645056");
}

TEST_F(V4l2StreamTest, StartOfExposureStampsMoveToTheMiddle) {
  begin(settings());
  const Result<FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok());
  const Instant middle = device_.start_of_exposure(0) + kExposureTime / 2;
  EXPECT_GT(frame.value().frame().capture_time, middle - kMicrosecond);
  EXPECT_LE(frame.value().frame().capture_time, middle);
}

TEST_F(V4l2StreamTest, EndOfFrameStampsMoveBackByHalfTheExposure) {
  device_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  begin(settings());
  const Result<FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok());
  const Instant expected = device_.start_of_exposure(0) + fake::VideoDevice::kReadout + kExposureTime / 2;
  EXPECT_GT(frame.value().frame().capture_time, expected - kMicrosecond);
  EXPECT_LE(frame.value().frame().capture_time, expected);
}

// uvcvideo flags its time stamps as start of exposure, but stamps the arrival of the first row, after its exposure.
TEST_F(V4l2StreamTest, StampsOfUvcvideoMoveBackByHalfTheExposure) {
  device_.driver = "uvcvideo";
  begin(settings());
  const bool computes = hal::uvc_computes_stamps();  // depends on the driver's option on this machine
  const std::string word = computes ? "stamps of the start of exposure" : "stamps of the first packet";
  EXPECT_NE(camera_->info().description.find(word), std::string::npos) << camera_->info().description;
  const Result<FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok());
  const Instant expected = device_.start_of_exposure(0) + (computes ? kExposureTime : -kExposureTime) / 2;
  EXPECT_GT(frame.value().frame().capture_time, expected - kMicrosecond);
  EXPECT_LE(frame.value().frame().capture_time, expected);
}

TEST_F(V4l2StreamTest, AnUnknownExposureIsNotCorrected) {
  CameraSettings requested = settings();
  requested.exposure_us = 0;  // stays automatic
  begin(requested);
  const Result<FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok());
  const Instant start = device_.start_of_exposure(0);
  EXPECT_GT(frame.value().frame().capture_time, start - kMicrosecond);
  EXPECT_LE(frame.value().frame().capture_time, start);
}

TEST_F(V4l2StreamTest, StampsOfOtherClocksAreReplacedByTheTimeOfDequeuing) {
  device_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
  device_.frame_faults[0].stamp_shift = -std::chrono::seconds(500);
  begin(settings());
  const Result<FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok());
  const Instant expected = kernel_.now() - kExposureTime / 2;
  EXPECT_GT(frame.value().frame().capture_time, expected - 2 * kMicrosecond);
  EXPECT_LE(frame.value().frame().capture_time, expected);
  EXPECT_EQ(camera_->stamps().replaced(), 0u) << "reported once at open(), not counted as a fault";
}

TEST_F(V4l2StreamTest, EveryBufferIsRequeuedExactlyOnce) {
  begin(settings());
  EXPECT_EQ(device_.queued(), 4u);
  const int before = device_.requests(VIDIOC_QBUF);
  {
    Result<FrameLease> first = camera_->wait(soon());
    ASSERT_TRUE(first.ok());
    EXPECT_EQ(device_.queued(), 3u);
    FrameLease moved = std::move(first).value();
    FrameLease target;
    target = std::move(moved);
    EXPECT_EQ(device_.requests(VIDIOC_QBUF), before);
    target = FrameLease();
    EXPECT_EQ(device_.requests(VIDIOC_QBUF), before + 1);
  }
  EXPECT_EQ(device_.requests(VIDIOC_QBUF), before + 1);
  EXPECT_EQ(device_.queued(), 4u);
}

TEST_F(V4l2StreamTest, WaitTimesOutWhileAllBuffersAreLent) {
  begin(settings());
  std::vector<FrameLease> leases;
  for (std::uint32_t i = 0; i < 4; ++i) {
    Result<FrameLease> frame = camera_->wait(soon());
    ASSERT_TRUE(frame.ok());
    leases.push_back(std::move(frame).value());
  }
  expect_loss(*camera_, ErrorCode::kTimeout, "/dev/video0: no frame can arrive: all 4 buffers are in use");
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(number_in(leases[i].frame()), i) << "a leased frame was overwritten";
  leases.clear();
  const Result<FrameLease> next = camera_->wait(soon());
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(camera_->counters().lost, next.value().frame().sequence - 4u);
  EXPECT_EQ(camera_->counters().lost, 6u) << "100 ms at 60 Hz";
}

TEST_F(V4l2StreamTest, TimesOutAtTheDeadline) {
  begin(settings());
  const Instant deadline = kernel_.now() + std::chrono::milliseconds(3);
  const Result<FrameLease> frame = camera_->wait(deadline);
  expect_error(frame, ErrorCode::kTimeout, "/dev/video0: no frame before the deadline");
  EXPECT_GE(kernel_.now(), deadline);
  EXPECT_LE(kernel_.now(), deadline + 10 * kMicrosecond);
  expect_frame(*camera_, 0);
}

TEST_F(V4l2StreamTest, APastDeadlineStillReturnsAvailableFrames) {
  begin(settings());
  kernel_.advance(std::chrono::milliseconds(40));
  for (std::uint32_t i = 0; i < 2; ++i) {
    const Result<FrameLease> frame = camera_->wait(Instant{});
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(frame.value().frame().sequence, i);
  }
  EXPECT_EQ(camera_->wait(Instant{}).code(), ErrorCode::kTimeout);
}

TEST_F(V4l2StreamTest, SignalsDoNotShortenTheWait) {
  begin(settings());
  kernel_.interrupt_waits(10);
  kernel_.interrupt_requests(10);
  expect_frame(*camera_, 0);
}

TEST_F(V4l2StreamTest, StopAndStartResetTheCounters) {
  begin(settings());
  expect_frame(*camera_, 0);
  expect_frame(*camera_, 1);
  camera_->stop();
  EXPECT_FALSE(device_.streaming());
  expect_loss(*camera_, ErrorCode::kInconsistent, "/dev/video0: not streaming");
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_EQ(device_.queued(), 4u);
  expect_frame(*camera_, 0);
  EXPECT_EQ(camera_->counters().frames, 1u);
  EXPECT_EQ(camera_->counters().lost, 0u);
}

TEST_F(V4l2StreamTest, ALeaseThatEndsAfterTheStopRequeuesNothing) {
  begin(settings());
  const int before = device_.requests(VIDIOC_QBUF);
  {
    Result<FrameLease> frame = camera_->wait(soon());
    ASSERT_TRUE(frame.ok());
    camera_->stop();
  }
  EXPECT_EQ(device_.requests(VIDIOC_QBUF), before);
}

TEST_F(V4l2StreamTest, AllocatesNothingDuringFramesAndFaults) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "the sanitizer replaces the allocator";
  for (std::uint32_t i = 0; i < 1000; i += 10) {
    device_.frame_faults[i + 1].damaged = true;
    device_.frame_faults[i + 3].bytes = 100;
    device_.frame_faults[i + 5].dropped = true;
    device_.frame_faults[i + 7].stamp_shift = -std::chrono::seconds(2);
  }
  device_.gone_at_frame = 1000;
  begin(settings());
  const DriverAllocations counter;
  std::array<int, 16> outcomes{};
  for (int i = 0; i < 2000; ++i) {
    if (i % 50 == 0) device_.spurious_wakeups = 3;
    const Result<FrameLease> frame = camera_->wait(kernel_.now() + std::chrono::milliseconds(i % 3 == 0 ? 5 : 50));
    ++outcomes[static_cast<std::size_t>(frame.code())];
    if (frame.code() == ErrorCode::kDisconnected) break;
  }
  const std::uint64_t allocations = counter.count();
  EXPECT_EQ(allocations, 0u);
  EXPECT_EQ(outcomes[static_cast<std::size_t>(ErrorCode::kOk)], 700);
  EXPECT_EQ(outcomes[static_cast<std::size_t>(ErrorCode::kCorruptFrame)], 100);
  EXPECT_EQ(outcomes[static_cast<std::size_t>(ErrorCode::kShortFrame)], 100);
  EXPECT_GT(outcomes[static_cast<std::size_t>(ErrorCode::kTimeout)], 10);
  EXPECT_EQ(outcomes[static_cast<std::size_t>(ErrorCode::kDisconnected)], 1);
  EXPECT_EQ(camera_->counters().lost, 100u);
  EXPECT_EQ(camera_->stamps().replaced(), 100u);
}

TEST_F(V4l2StreamTest, TheAllocationCounterSeesAnAllocation) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "the sanitizer replaces the allocator";
  const DriverAllocations counter;
  ::operator delete(::operator new(100));  // called by name: a new-expression could be optimized away
  EXPECT_EQ(counter.count(), 1u);
  {
    const UncountedAllocations fake, inside_a_fake;
    ::operator delete(::operator new(100));
  }
  EXPECT_EQ(counter.count(), 1u);
}

}  // namespace
}  // namespace touchline::testing
