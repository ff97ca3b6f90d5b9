#include <array>
#include <cerrno>

#include "tests/linux/libcamera_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using hal::CameraSettings;
using hal::FrameLease;

class LibcameraOpenTest : public LibcameraTest {
 protected:
  static CameraSettings of_device(const char* device) {
    CameraSettings requested = settings();
    requested.device = device;
    return requested;
  }
  void expect_camera(const char* device, const char* id) {
    begin(of_device(device));
    EXPECT_EQ(world_.acquired, id);
  }
};

TEST_F(LibcameraOpenTest, ABuildWithoutLibcameraReportsThat) {
  camera_.emplace(settings(), 0, nullptr);
  expect_error(
      camera_->open(), ErrorCode::kUnsupported,
      "camera.backend = \"libcamera\": this build is without libcamera; install libcamera-dev and build again");
  EXPECT_EQ(camera_->start().code(), ErrorCode::kInconsistent);
}

TEST_F(LibcameraOpenTest, CamerasAreFoundByIdByAPartOfItOrAutomatically) {
  world_.cameras = {{"usb-1.2:1.0-046d:0825", "Webcam", true},
                    {"/base/axi/pcie@120000/rp1/i2c@88000/imx708@1a", "imx708", false},
                    {"/base/axi/pcie@120000/rp1/i2c@80000/imx708@1a", "imx708", false}};
  expect_camera("auto", "/base/axi/pcie@120000/rp1/i2c@88000/imx708@1a");  // not the USB camera
  expect_camera("i2c@80000", "/base/axi/pcie@120000/rp1/i2c@80000/imx708@1a");
  expect_camera("usb-1.2:1.0-046d:0825", "usb-1.2:1.0-046d:0825");
  expect_refusal(of_device("imx708"), ErrorCode::kNotFound,
                 "imx708: no such camera; available cameras: usb-1.2:1.0-046d:0825 (Webcam), "
                 "/base/axi/pcie@120000/rp1/i2c@88000/imx708@1a (imx708), "
                 "/base/axi/pcie@120000/rp1/i2c@80000/imx708@1a (imx708)");
  world_.cameras.resize(1);
  expect_camera("auto", "usb-1.2:1.0-046d:0825");
  world_.cameras.clear();
  expect_refusal(settings(), ErrorCode::kNotFound,
                 "auto: no such camera; available cameras: none (is it plugged in, and the user in the group video?)");
}

TEST_F(LibcameraOpenTest, AMirrorImageIsReported) {
  begin(settings());
  EXPECT_EQ(camera_->info().negotiated.find("mirror"), std::string::npos) << camera_->info().negotiated;
  world_.mirrored = true;
  begin(settings());
  EXPECT_NE(camera_->info().negotiated.find("libcamera delivers a mirror image"), std::string::npos)
      << camera_->info().negotiated;
}

TEST_F(LibcameraOpenTest, ErrorsNameTheFailedCall) {
  const std::string id = kId;
  world_.errors = {{"cameras", ENOMEM}};
  expect_refusal(settings(), ErrorCode::kIo, "libcamera cannot be started: Cannot allocate memory");
  world_.errors = {{"acquire", EBUSY}};
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 id + ": in use by another process; `fuser -v /dev/media* /dev/video*` shows it");
  world_.errors = {{"configure", EIO}};
  expect_refusal(settings(), ErrorCode::kIo, id + ": setting a format failed: Input/output error");
  world_.errors = {{"use_buffers", ENOMEM}};
  expect_refusal(settings(), ErrorCode::kIo, id + ": using buffers of a DMA heap failed: Cannot allocate memory");
  for (const char* call : {"start", "queue"}) {
    make(settings());
    ASSERT_TRUE(camera_->open().ok());
    world_.errors = {{call, EIO}};
    expect_error(camera_->start(), ErrorCode::kIo, id + ": starting the stream failed: Input/output error");
    EXPECT_FALSE(world_.running);
    EXPECT_OK(camera_->start());  // the next attempt succeeds
  }
}

TEST_F(LibcameraOpenTest, AnUnavailableFormatListsTheAvailableOnes) {
  world_.errors = {{"configure", EINVAL}};
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 std::string(kId) + ": nv12 640x480 is not available; the camera offers nv12 32x32 to 3280x2464");
  CameraSettings requested = settings();
  requested.format = hal::CameraFormat::kMjpg;
  expect_refusal(requested, ErrorCode::kUnsupported,
                 std::string(kId) + ": libcamera does not offer mjpg; for a USB camera use backend v4l2");
}

TEST_F(LibcameraOpenTest, PlanesAndStridesAreSetForAllFormats) {
  struct Case {
    hal::CameraFormat format;
    std::uint32_t pixel_bytes;
  };
  constexpr std::array<Case, 8> kCases{{{hal::CameraFormat::kRgb24, 3},
                                        {hal::CameraFormat::kBgr24, 3},
                                        {hal::CameraFormat::kYuyv, 2},
                                        {hal::CameraFormat::kUyvy, 2},
                                        {hal::CameraFormat::kNv12, 1},
                                        {hal::CameraFormat::kI420, 1},
                                        {hal::CameraFormat::kXrgb8888, 4},
                                        {hal::CameraFormat::kYuvj422p, 1}}};
  world_.padding_bytes = 32;
  world_.spare_bytes = 4096;
  for (const Case& example : kCases) {
    CameraSettings requested = settings();
    requested.format = example.format;
    begin(requested);
    const std::uint32_t stride = 640 * example.pixel_bytes + 32;
    world_.complete(7);
    Result<FrameLease> lease = camera_->wait(late());
    ASSERT_TRUE(lease.ok()) << lease.text();
    const Frame& frame = lease.value().frame();
    EXPECT_EQ(frame.format, pixel_format(example.format));
    EXPECT_EQ(frame.width_px, 640);
    EXPECT_EQ(frame.height_px, 480);
    EXPECT_EQ(frame.stride_bytes[0], stride);
    EXPECT_EQ(frame.plane[0][stride * 479], 7);
    if (frame.format == PixelFormat::kNv12) {
      EXPECT_EQ(frame.stride_bytes[1], stride);
      EXPECT_EQ(frame.plane[1], frame.plane[0] + stride * 480);
      EXPECT_EQ(frame.plane[1][stride * 239], 7);
    } else if (frame.format == PixelFormat::kI420) {
      EXPECT_EQ(frame.stride_bytes[1], stride / 2);
      EXPECT_EQ(frame.stride_bytes[2], stride / 2);
      EXPECT_EQ(frame.plane[1], frame.plane[0] + stride * 480);
      EXPECT_EQ(frame.plane[2], frame.plane[1] + stride / 2 * 240);
      EXPECT_EQ(frame.plane[2][stride / 2 * 239], 7);
    } else if (frame.format == PixelFormat::kYuvj422p) {
      EXPECT_EQ(frame.stride_bytes[2], stride / 2);
      EXPECT_EQ(frame.plane[2], frame.plane[1] + stride / 2 * 480);
      EXPECT_EQ(frame.plane[2][stride / 2 * 479], 7);
    } else {
      EXPECT_EQ(frame.plane[1], nullptr);
    }
    EXPECT_EQ(camera_->info().format, frame.format);
    EXPECT_EQ(lease.value().dma_bufs()[1], -1) << "one memory plane";
    EXPECT_GE(lease.value().dma_bufs()[0], 0);
    lease = failure(ErrorCode::kTimeout, "the lease ends");
    camera_->close();
  }
}

TEST_F(LibcameraOpenTest, FullRangeAndAnotherNumberOfBuffersAreReported) {
  world_.full_range = true;
  world_.actual_buffers = 6;
  begin();
  EXPECT_EQ(camera_->info().negotiated,
            std::string(kId) +
                ": full-range YUV: the darkest 16 levels are treated as black; "
                "buffers = 4: set to 6; rate_hz = 60: the camera does not report its frame rate");
  for (const hal::CameraFormat format : {hal::CameraFormat::kRgb24, hal::CameraFormat::kYuvj422p}) {
    CameraSettings requested = settings();
    requested.format = format;
    begin(requested);
    EXPECT_EQ(camera_->info().negotiated,
              std::string(kId) + ": buffers = 4: set to 6; rate_hz = 60: the camera does not report its frame rate");
  }
  world_.actual_buffers = 1;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 std::string(kId) + ": the camera provides 1 buffers; 2 to 32 are needed");
  world_.actual_buffers = 33;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 std::string(kId) + ": the camera provides 33 buffers; 2 to 32 are needed");
}

TEST_F(LibcameraOpenTest, BuffersComeFromADmaHeapElseFromTheDriver) {
  begin();
  EXPECT_TRUE(world_.heap_used);
  EXPECT_EQ(heap_.buffers().size(), 4u);
  camera_.reset();

  world_.heap_used = false;
  heap_.room = 1000000;  // two pictures
  begin();
  EXPECT_FALSE(world_.heap_used);
  EXPECT_EQ(camera_->info().negotiated,
            std::string(kId) +
                ": no memory from a DMA heap (/dev/dma_heap/linux,cma: Cannot allocate memory): the "
                "driver's own buffers may be slow to read; rate_hz = 60: the camera does not report its frame rate");
  world_.complete(3);
  expect_frame(3);
  camera_.reset();

  kernel_.refuse_open("/dev/dma_heap/linux,cma", EACCES);
  begin();
  EXPECT_FALSE(world_.heap_used);
  EXPECT_NE(camera_->info().negotiated.find("(/dev/dma_heap/linux,cma: Permission denied)"), std::string::npos)
      << camera_->info().negotiated;
  world_.errors = {{"make_buffers", ENOBUFS}};
  expect_refusal(settings(), ErrorCode::kIo,
                 std::string(kId) + ": allocating buffers failed: No buffer space available");
  world_.missing_bytes = 1;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 std::string(kId) + ": plane 1 of a buffer has 153599 bytes, a picture needs 153600");
}

}  // namespace
}  // namespace touchline::testing
