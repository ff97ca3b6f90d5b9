#include <cerrno>

#include "tests/linux/v4l2_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using hal::FrameLease;
using hal::V4l2Camera;

class V4l2FaultTest : public V4l2RunningTest {
 protected:
  /// wait() must return the same error again without a request to the driver.
  void expect_permanent_error(ErrorCode code) {
    const int requests = device_.requests(VIDIOC_DQBUF);
    const std::string text = camera_->wait(soon()).text();
    EXPECT_NE(text, "");
    expect_loss(*camera_, code, text);
    EXPECT_EQ(device_.requests(VIDIOC_DQBUF), requests);
  }
};

TEST_F(V4l2FaultTest, DamagedAndShortFramesAreRequeuedAndTheNextIsGood) {
  device_.frame_faults[1].damaged = true;
  device_.frame_faults[2].bytes = 307200;
  device_.frame_faults[3].bytes = 0;
  begin();
  expect_frame(*camera_, 0);
  expect_loss(*camera_, ErrorCode::kCorruptFrame, "/dev/video0: the driver marks frame 1 as damaged");
  EXPECT_EQ(device_.queued(), 4u);
  expect_loss(*camera_, ErrorCode::kShortFrame, "/dev/video0: frame 2 has 307200 bytes instead of 614400");
  expect_loss(*camera_, ErrorCode::kShortFrame, "/dev/video0: frame 3 has 0 bytes instead of 614400");
  EXPECT_EQ(device_.queued(), 4u);
  expect_frame(*camera_, 4);
  EXPECT_EQ(camera_->counters().corrupt, 1u);
  EXPECT_EQ(camera_->counters().short_frames, 2u);
  EXPECT_EQ(camera_->counters().frames, 2u);
  EXPECT_EQ(camera_->counters().lost, 0u) << "they arrived, although damaged";
}

TEST_F(V4l2FaultTest, AnErrorWhileStreamingRequiresReopening) {
  begin();
  expect_frame(*camera_, 0);
  device_.fail(VIDIOC_DQBUF, EIO);
  expect_loss(*camera_, ErrorCode::kIo, "/dev/video0: dequeuing a frame failed: Input/output error");
  expect_permanent_error(ErrorCode::kIo);
  camera_->close();
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  expect_frame(*camera_, 0);
}

TEST_F(V4l2FaultTest, CanBeReopenedAfterReplugging) {
  device_.gone_at_frame = 2;
  begin();
  expect_frame(*camera_, 0);
  expect_frame(*camera_, 1);
  expect_loss(*camera_, ErrorCode::kDisconnected, "/dev/video0: the camera went away (dequeuing a frame)");
  expect_permanent_error(ErrorCode::kDisconnected);
  camera_->close();
  EXPECT_EQ(kernel_.open_files(), 0u);
  kernel_.remove("/dev/video0");
  EXPECT_EQ(camera_->open().code(), ErrorCode::kNotFound);

  fake::VideoDevice again;
  kernel_.add("/dev/video0", again);
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_EQ(again.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
  expect_frame(*camera_, 0);
  camera_.reset();
  EXPECT_EQ(again.mapped(), 0u);
}

TEST_F(V4l2FaultTest, IsFoundByItsSocketAfterReplugging) {
  constexpr const char* kByPath = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0";
  kernel_.link(kByPath, "/dev/video0");
  for (const char* const named : {kByPath, "/dev/video0"}) {
    fake::VideoDevice before, after, other;
    kernel_.add("/dev/video0", before);
    kernel_.link(kByPath, "/dev/video0");
    before.gone_at_frame = 1;
    hal::CameraSettings requested = settings();
    requested.device = named;
    begin(requested);
    expect_frame(*camera_, 0);
    EXPECT_EQ(camera_->wait(soon()).code(), ErrorCode::kDisconnected);
    camera_->close();
    kernel_.unlink(kByPath);
    kernel_.remove("/dev/video0");
    EXPECT_EQ(camera_->open().code(), ErrorCode::kNotFound) << named;

    kernel_.add("/dev/video0", other);  // another camera gets the number
    kernel_.add("/dev/video3", after);
    kernel_.link(kByPath, "/dev/video3");
    ASSERT_OK(camera_->open());
    ASSERT_TRUE(camera_->start().ok());
    EXPECT_TRUE(after.streaming()) << named;
    EXPECT_EQ(other.mapped(), 0u) << named;
    expect_frame(*camera_, 0);
    camera_.reset();
    kernel_.remove("/dev/video3");
  }
  kernel_.add("/dev/video0", device_);
}

TEST_F(V4l2FaultTest, IsFoundByItsNumberInAnotherSocket) {
  constexpr const char* kByPath = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0";
  kernel_.link(kByPath, "/dev/video0");
  begin();
  camera_->stop();
  camera_->close();
  kernel_.unlink(kByPath);
  kernel_.link("/dev/v4l/by-path/pci-0000:00:14.0-usb-0:2:1.0-video-index0", "/dev/video0");
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  expect_frame(*camera_, 0);
  camera_->stop();
  camera_->close();

  fake::VideoDevice other;  // another camera is plugged into the former socket
  kernel_.add("/dev/video1", other);
  kernel_.link(kByPath, "/dev/video1");
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_TRUE(device_.streaming());
  EXPECT_EQ(other.mapped(), 0u);
  camera_.reset();
  kernel_.remove("/dev/video1");
}

TEST_F(V4l2FaultTest, TheLinkOfAnUnusableCameraIsNotStored) {
  constexpr const char* kByPath = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0";
  constexpr const char* kOther = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:2:1.0-video-index0";
  kernel_.link(kByPath, "/dev/video0");
  begin();
  camera_->stop();
  camera_->close();
  kernel_.unlink(kByPath);
  fake::VideoDevice useless;
  useless.formats = {{V4L2_PIX_FMT_GREY, {{640, 480}}, false}};
  kernel_.add("/dev/video0", useless);
  kernel_.link(kOther, "/dev/video0");
  EXPECT_EQ(camera_->open().code(), ErrorCode::kUnsupported);
  kernel_.add("/dev/video1", device_);
  kernel_.link(kByPath, "/dev/video1");
  ASSERT_OK(camera_->open());
  ASSERT_TRUE(camera_->start().ok());
  EXPECT_TRUE(device_.streaming());
  camera_.reset();
  kernel_.remove("/dev/video1");
  kernel_.add("/dev/video0", device_);
}

TEST_F(V4l2FaultTest, AStalledStreamTimesOutUntilReopened) {
  device_.stalls_at_frame = 3;
  begin();
  for (std::uint32_t i = 0; i < 3; ++i) expect_frame(*camera_, i);
  for (int i = 0; i < 10; ++i) expect_loss(*camera_, ErrorCode::kTimeout, "/dev/video0: no frame before the deadline");
  device_.stalls_at_frame = -1;
  camera_->stop();  // as the loop does after camera_timeout_s
  camera_->close();
  ASSERT_TRUE(camera_->open().ok());
  ASSERT_TRUE(camera_->start().ok());
  expect_frame(*camera_, 0);
}

TEST_F(V4l2FaultTest, UnpluggingDuringALeaseIsReported) {
  begin();
  {
    const Result<FrameLease> frame = camera_->wait(soon());
    ASSERT_TRUE(frame.ok());
    device_.unplug();
  }
  expect_loss(*camera_, ErrorCode::kDisconnected, "/dev/video0: the camera went away (queuing a buffer)");
}

TEST_F(V4l2FaultTest, AFailureToRequeueADamagedFrameIsADeviceError) {
  device_.frame_faults[0].damaged = true;
  begin();
  device_.fail(VIDIOC_QBUF, EIO);
  expect_loss(*camera_, ErrorCode::kIo, "/dev/video0: queuing a buffer failed: Input/output error");
}

TEST_F(V4l2FaultTest, SpuriousWakeupsNeitherEndTheWaitNorSpin) {
  begin();
  device_.spurious_wakeups = 1000000;
  const int before = device_.requests(VIDIOC_DQBUF);
  expect_loss(*camera_, ErrorCode::kTimeout, "/dev/video0: no frame before the deadline");
  const int tries = device_.requests(VIDIOC_DQBUF) - before;
  EXPECT_GE(tries, 150);
  EXPECT_LE(tries, 210) << "100 ms with one request every 500 us";
  device_.spurious_wakeups = 5;
  const Result<FrameLease> frame = camera_->wait(soon());
  EXPECT_TRUE(frame.ok());
}

TEST_F(V4l2FaultTest, ASlowReaderGetsTheNewestFrame) {
  begin();
  const auto next = [&] {
    const Result<hal::FrameLease> frame = camera_->wait(soon());
    EXPECT_TRUE(frame.ok()) << frame.text();
    return frame.value().frame().sequence;
  };
  EXPECT_EQ(next(), 0u);
  kernel_.advance(std::chrono::milliseconds(60));  // a single delay: the buffered frames are still delivered
  for (std::uint32_t i = 1; i < 10; ++i) EXPECT_EQ(next(), i);
  std::uint32_t last = 0;
  for (int i = 0; i < 20; ++i) {
    kernel_.advance(std::chrono::milliseconds(25));
    last = next();
    const Duration age = kernel_.now() - device_.start_of_exposure(last);
    EXPECT_LE(seconds(age), 0.005 + seconds(fake::VideoDevice::kReadout) + (i > 5 ? 1 : 4) / 60.0) << i;
  }
  EXPECT_EQ(camera_->counters().lost, last - (10u + 20u) + 1);
  kernel_.advance(std::chrono::milliseconds(5));
  for (std::uint32_t i = 1; i < 10; ++i) EXPECT_EQ(next(), last + i) << "the reader is fast enough again";
}

TEST_F(V4l2FaultTest, ADamagedNewestFrameIsSkipped) {
  begin();
  std::uint32_t good = 0;
  for (std::uint32_t i = 1; i < 400; i += 2) device_.frame_faults[i].damaged = true;
  for (int i = 0; i < 60; ++i) {
    kernel_.advance(std::chrono::milliseconds(50));
    good += camera_->wait(soon()).ok() ? 1u : 0u;
  }
  EXPECT_GT(good, 50u) << "each 50 ms contain a good frame";
}

TEST_F(V4l2FaultTest, GapsInTheSequenceAreLostFrames) {
  device_.frame_faults[1].dropped = true;
  device_.frame_faults[2].dropped = true;
  device_.frame_faults[4].dropped = true;
  begin();
  expect_frame(*camera_, 0);
  expect_frame(*camera_, 3);
  expect_frame(*camera_, 5);
  EXPECT_EQ(camera_->counters().lost, 3u);
}

TEST_F(V4l2FaultTest, ARepeatedOrDecreasingSequenceIsContinued) {
  device_.frame_faults[1].sequence = 0;
  device_.frame_faults[2].sequence = 0;
  device_.frame_faults[4].sequence = 1;
  begin();
  for (std::uint32_t i = 0; i < 7; ++i) expect_frame(*camera_, i);
  EXPECT_EQ(camera_->counters().lost, 0u);
}

TEST_F(V4l2FaultTest, TheSequenceNumberWrapsAround) {
  device_.frame_faults[0].sequence = 0xfffffffe;
  device_.frame_faults[1].sequence = 0xffffffff;
  device_.frame_faults[2].sequence = 1;
  begin();
  expect_frame(*camera_, 0xfffffffe);
  expect_frame(*camera_, 0xffffffff);
  expect_frame(*camera_, 1);
  EXPECT_EQ(camera_->counters().lost, 1u);
}

TEST_F(V4l2FaultTest, DecreasingAndFutureStampsAreReplacedAndTimeIncreases) {
  device_.frame_faults[2].stamp_shift = -std::chrono::milliseconds(50);
  device_.frame_faults[4].stamp_shift = std::chrono::hours(1);
  begin();
  Instant last{};
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Result<FrameLease> frame = camera_->wait(soon());
    ASSERT_TRUE(frame.ok());
    const Instant captured = frame.value().frame().capture_time;
    EXPECT_GT(captured, last) << i;
    EXPECT_LE(captured, kernel_.now()) << i;
    EXPECT_GT(captured, kernel_.now() - std::chrono::milliseconds(17)) << i;
    last = captured;
  }
  EXPECT_EQ(camera_->stamps().replaced(), 2u);
}

TEST_F(V4l2FaultTest, ErrorsAtTheStartAreReported) {
  V4l2Camera camera(settings());
  expect_error(camera.start(), ErrorCode::kInconsistent, "/dev/video0: not open");
  ASSERT_TRUE(camera.open().ok());
  device_.fail(VIDIOC_STREAMON, ENOSPC);
  expect_error(
      camera.start(), ErrorCode::kUnsupported,
      "/dev/video0: the USB bus has no bandwidth left for 640x480 at 60 Hz; use another port or a smaller picture");
  camera.close();
  ASSERT_TRUE(camera.open().ok());
  device_.fail(VIDIOC_STREAMON, EBUSY);
  expect_error(camera.start(), ErrorCode::kDeviceBusy,
               "/dev/video0: in use by another process; `fuser -v /dev/video0` shows it");
  camera.close();
  ASSERT_TRUE(camera.open().ok());
  device_.fail(VIDIOC_STREAMON, EPIPE);
  expect_error(camera.start(), ErrorCode::kIo, "/dev/video0: starting the stream failed: Broken pipe");
  camera.close();
  device_.bus = "platform:rkisp1";
  for (const int error : {EPIPE, ENOLINK}) {
    ASSERT_TRUE(camera.open().ok());
    device_.fail(VIDIOC_STREAMON, error);
    // Not kUnsupported: the pipeline may still be configured.
    expect_error(camera.start(), ErrorCode::kIo,
                 "/dev/video0: no stream: the entities of the media pipeline are not linked, or not all set to 640x480 "
                 "(`media-ctl "
                 "-p`)");
    camera.close();
  }
  ASSERT_TRUE(camera.open().ok());
  device_.fail(VIDIOC_QBUF, ENODEV, 1);
  expect_error(camera.start(), ErrorCode::kDisconnected, "/dev/video0: the camera went away (queuing buffers)");
}

}  // namespace
}  // namespace touchline::testing
