// Pictures in several memory planes, and memory that is shared with other devices.
#include <cerrno>
#include <cstring>

#include "tests/linux/v4l2_fixture.h"

namespace touchline::testing {
namespace {

using hal::CameraFormat;
using hal::FrameLease;
using hal::V4l2Camera;

class V4l2MemoryTest : public V4l2RunningTest {
 protected:
  V4l2MemoryTest() {
    device_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
    device_.formats = {{V4L2_PIX_FMT_NV12M, {{320, 240}}, false}};
  }
  static hal::CameraSettings nv12() {
    hal::CameraSettings requested = settings();
    requested.format = CameraFormat::kNv12;
    requested.width_px = 320;
    requested.height_px = 240;
    return requested;
  }
};

TEST_F(V4l2MemoryTest, Nv12InTwoMemoryPlanesIsRead) {
  device_.padding_bytes = 16;
  device_.plane_offset = 128;
  begin(nv12());
  EXPECT_EQ(device_.exported(), 8u);
  for (std::uint32_t i = 0; i < 10; ++i) {
    const Result<FrameLease> result = camera_->wait(soon());
    ASSERT_TRUE(result.ok()) << result.text();
    const Frame& frame = result.value().frame();
    EXPECT_EQ(frame.format, PixelFormat::kNv12);
    EXPECT_EQ(frame.stride_bytes[0], 336u);
    EXPECT_EQ(frame.stride_bytes[1], 336u);
    EXPECT_EQ(frame.plane[2], nullptr);
    for (const std::uint8_t* const plane : {frame.plane[0], frame.plane[1]}) {
      std::uint32_t number = 99;
      std::memcpy(&number, plane, sizeof number);
      EXPECT_EQ(number, i);
    }
    EXPECT_EQ(frame.plane[0][336 * 240 - 1], i);
    EXPECT_EQ(frame.plane[1][336 * 120 - 1], i);
    EXPECT_GE(result.value().dma_bufs()[0], 0);
    EXPECT_GE(result.value().dma_bufs()[1], 0);
    EXPECT_NE(result.value().dma_bufs()[0], result.value().dma_bufs()[1]);
  }
}

TEST_F(V4l2MemoryTest, I420InThreeMemoryPlanesIsRead) {
  device_.formats = {{V4L2_PIX_FMT_YUV420M, {{320, 240}}, false}};
  device_.padding_bytes = 16;
  device_.plane_offset = 128;
  hal::CameraSettings requested = nv12();
  requested.format = CameraFormat::kI420;
  begin(requested);
  EXPECT_EQ(device_.exported(), 12u);
  for (std::uint32_t i = 0; i < 10; ++i) {
    const auto result = camera_->wait(soon());
    ASSERT_TRUE(result.ok());
    const Frame& frame = result.value().frame();
    EXPECT_EQ(frame.format, PixelFormat::kI420);
    EXPECT_EQ(frame.stride_bytes, (std::array<std::uint32_t, 3>{336, 168, 168}));
    for (const std::uint8_t* const plane : frame.plane) {
      std::uint32_t number = 99;
      std::memcpy(&number, plane, sizeof number);
      EXPECT_EQ(number, i);
    }
    EXPECT_EQ(frame.plane[0][336 * 240 - 1], i);
    EXPECT_EQ(frame.plane[1][168 * 120 - 1], i);
    EXPECT_EQ(frame.plane[2][168 * 120 - 1], i);
    for (const int file : result.value().dma_bufs()) EXPECT_GE(file, 0);
  }
}

TEST_F(V4l2MemoryTest, Nv12InOneMemoryPlaneIsPreferred) {
  device_.formats.push_back({V4L2_PIX_FMT_NV12, {{320, 240}}, false});
  begin(nv12());
  EXPECT_EQ(device_.exported(), 4u);
  const Result<FrameLease> result = camera_->wait(soon());
  ASSERT_TRUE(result.ok());
  const Frame& frame = result.value().frame();
  EXPECT_EQ(frame.plane[1], frame.plane[0] + 320 * 240);
  EXPECT_EQ(result.value().dma_bufs()[1], -1);
}

TEST_F(V4l2MemoryTest, TheSinglePlanarInterfaceIsPreferred) {
  device_.capabilities |= V4L2_CAP_VIDEO_CAPTURE;
  device_.formats = {{V4L2_PIX_FMT_YUYV, {{640, 480}}, false}};
  begin();
  expect_frame(*camera_, 0);
}

TEST_F(V4l2MemoryTest, AShortSecondPlaneMakesAShortFrame) {
  device_.frame_faults[1].bytes = 320 * 120 - 1;
  begin(nv12());
  expect_frame(*camera_, 0);
  expect_loss(*camera_, ErrorCode::kShortFrame, "/dev/video0: frame 1 has 38399 bytes instead of 38400");
  expect_frame(*camera_, 2);
}

TEST_F(V4l2MemoryTest, UnavailableFormatsListTheAvailableOnes) {
  hal::CameraSettings requested = nv12();
  requested.format = CameraFormat::kYuyv;
  expect_refusal(
      requested, ErrorCode::kUnsupported,
      "/dev/video0: yuyv 320x240 is not available (the driver set nv12 320x240); the camera offers nv12 320x240");
}

TEST_F(V4l2MemoryTest, MemoryIsCachedAndSynchronizedWhileItIsRead) {
  device_.sync_interruptions = 3;
  begin(nv12());
  EXPECT_TRUE(device_.cached_memory_requested());
  EXPECT_EQ(device_.readable(), 0u);
  {
    Result<FrameLease> first = camera_->wait(soon()), second = camera_->wait(soon());
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_EQ(device_.readable(), 2u);
    const FrameLease moved = std::move(first).value();
    EXPECT_NE(moved.dma_bufs(), hal::kNoDmaBufs);
    EXPECT_EQ(device_.readable(), 2u);
  }
  EXPECT_EQ(device_.readable(), 0u);
  camera_->close();
  EXPECT_EQ(kernel_.open_files(), 0u);
}

TEST_F(V4l2MemoryTest, ADriverThatNeverSynchronizesDoesNotBlockTheLoop) {
  device_.sync_interruptions = 1000000;
  begin(nv12());
  expect_loss(*camera_, ErrorCode::kIo, "/dev/video0: synchronizing a buffer failed: Resource temporarily unavailable");
  camera_->close();
  device_.sync_interruptions = 0;
  begin(nv12());
  expect_frame(*camera_, 0);
}

TEST_F(V4l2MemoryTest, ADriverWithoutDmaBufExportStreams) {
  device_.exports = false;
  begin(nv12());
  expect_frame(*camera_, 0);
  const Result<FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame.value().dma_bufs(), hal::kNoDmaBufs);
  EXPECT_EQ(camera_->info().description.find("dma-buf"), std::string::npos);
}

TEST_F(V4l2MemoryTest, AFailedExportLeavesNoFileOpen) {
  device_.fail(VIDIOC_EXPBUF, ENOMEM, 5);
  begin(nv12());
  EXPECT_EQ(device_.exported(), 0u);
  EXPECT_EQ(kernel_.open_files(), 1u);
  expect_frame(*camera_, 0);
}

TEST_F(V4l2MemoryTest, AFailedMappingOfTheSecondPlaneLeavesNothingMapped) {
  device_.fail(VIDIOC_QUERYBUF, EIO, 2);
  expect_refusal(nv12(), ErrorCode::kIo, "/dev/video0: mapping buffers failed: Input/output error");
  EXPECT_EQ(device_.mapped(), 0u);
}

}  // namespace
}  // namespace touchline::testing
