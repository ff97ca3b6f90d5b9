#include <cerrno>

#include "tests/linux/v4l2_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using V4l2OpenTest = V4l2Test;
using hal::CameraFormat;
using hal::CameraSettings;
using hal::V4l2Camera;

TEST_F(V4l2OpenTest, NothingIsReportedIfAllSettingsAreAccepted) {
  V4l2Camera camera(settings());
  ASSERT_OK(camera.open());
  EXPECT_EQ(camera.info().negotiated, "");
  EXPECT_EQ(camera.info().format, PixelFormat::kYuyv);
  EXPECT_EQ(camera.info().width_px, 640);
  EXPECT_EQ(camera.info().height_px, 480);
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 60.0);
  EXPECT_EQ(device_.mapped(), 4u);
  EXPECT_EQ(camera.info().description,
            "/dev/video0 (Fake Camera, usb-0000:00:14.0-1): yuyv 640x480 at 60 Hz, 4 buffers mapped and shared as "
            "dma-bufs, time stamps of the start of exposure, exposure 5000 us, gain 64, white balance 4600 K, power "
            "line 60 Hz");
  camera.close();
  EXPECT_EQ(device_.mapped(), 0u);
  EXPECT_EQ(kernel_.open_files(), 0u);
}

TEST_F(V4l2OpenTest, ReopensAfterCloseAndWithoutClose) {
  V4l2Camera camera(settings());
  for (int i = 0; i < 3; ++i) {
    ASSERT_OK(camera.open());
    ASSERT_OK(camera.open());
    EXPECT_EQ(kernel_.open_files(), 1u + 4u) << "the device, and a dma-buf per buffer";
    camera.close();
  }
}

TEST_F(V4l2OpenTest, AMissingDeviceListsTheAvailableCameras) {
  kernel_.remove("/dev/video0");
  expect_refusal(settings(), ErrorCode::kNotFound, "/dev/video0: no such device; available cameras: none");

  fake::VideoDevice other, codec, planar;
  other.card = "HD Webcam";
  other.bus = "usb-0000:00:14.0-4";
  codec.capabilities = V4L2_CAP_VIDEO_M2M | V4L2_CAP_STREAMING;
  planar.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  kernel_.add("/dev/video2", other);
  kernel_.add("/dev/video10", codec);
  kernel_.add("/dev/video11", planar);
  kernel_.add("/dev/video12", device_);
  kernel_.link("/dev/v4l/by-path/pci-0000:00:14.0-usb-0:4:1.0-video-index0", "/dev/video2");
  expect_refusal(settings(), ErrorCode::kNotFound,
                 "/dev/video0: no such device; available cameras: /dev/video2 (HD Webcam, usb-0000:00:14.0-4) = "
                 "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:4:1.0-video-index0, "
                 "/dev/video11 (Fake Camera, usb-0000:00:14.0-1), /dev/video12 (Fake Camera, usb-0000:00:14.0-1)");
}

TEST_F(V4l2OpenTest, ANumberedDeviceIsReportedWithItsStableLink) {
  kernel_.link("/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0", "/dev/video0");
  kernel_.link("/dev/goal-camera", "/dev/video0");
  expect_negotiated(settings(),
                    "/dev/video0: device = \"/dev/video0\": the number depends on the order of plugging in; "
                    "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0 always names this camera");
  CameraSettings requested = settings();
  requested.device = "/dev/goal-camera";
  expect_negotiated(requested, "");
}

TEST_F(V4l2OpenTest, DifferencesFromTheSettingsAreReported) {
  device_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  device_.exports = false;
  device_.reports_rate = false;
  device_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  device_.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  device_.controls[V4L2_CID_FOCUS_AUTO] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 0};
  CameraSettings requested = settings();
  requested.exposure_us = requested.white_balance_k = 0;
  V4l2Camera camera(requested);
  ASSERT_TRUE(camera.open().ok());
  EXPECT_EQ(camera.info().negotiated,
            "/dev/video0: rate_hz = 60: the driver does not report its frame rate; full-range YUV: the darkest 16 "
            "levels are treated as black");
  EXPECT_EQ(camera.info().description,
            "/dev/video0 (Fake Camera, usb-0000:00:14.0-1): yuyv 640x480, 4 buffers mapped (multi-planar), time stamps "
            "of the "
            "end of frame, exposure automatic, gain 64, white balance automatic, focus automatic, power line 60 Hz");
}

TEST_F(V4l2OpenTest, LimitedRangeIsReportedForAFormatOfFullRange) {
  device_.formats = {{V4L2_PIX_FMT_YUV422P, {{640, 480}}, false}, {V4L2_PIX_FMT_MJPEG, {{640, 480}}, false}};
  CameraSettings requested = settings();
  requested.format = CameraFormat::kYuvj422p;
  expect_negotiated(requested, "/dev/video0: limited-range YUV: black appears 16 levels too bright");
  requested.format = CameraFormat::kMjpg;
  expect_negotiated(requested, "");
  device_.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  requested.format = CameraFormat::kYuvj422p;
  expect_negotiated(requested, "");
}

TEST_F(V4l2OpenTest, PermissionErrorsSayWhatToDo) {
  kernel_.refuse_open("/dev/video0", EACCES);
  expect_refusal(settings(), ErrorCode::kPermission,
                 "/dev/video0: permission denied; add the user to the group video (`sudo usermod -aG video $USER`) and "
                 "log in again");
  kernel_.refuse_open("/dev/video0", EBUSY);
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/video0: in use by another process; `fuser -v /dev/video0` shows it");
  kernel_.refuse_open("/dev/video0", EMFILE);
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: cannot be opened: Too many open files");
}

TEST_F(V4l2OpenTest, DevicesThatAreNotCamerasAreRefused) {
  device_.fail(VIDIOC_QUERYCAP, ENOTTY);
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: not a video device; available cameras: /dev/video0 (Fake Camera, usb-0000:00:14.0-1)");
  device_.fail(VIDIOC_QUERYCAP, ENODEV);
  expect_refusal(settings(), ErrorCode::kDisconnected, "/dev/video0: the camera went away (identifying)");

  device_.capabilities = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0 (Fake Camera): does not capture video; available cameras: none");
  device_.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_READWRITE;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0 (Fake Camera): cannot stream into mapped buffers; available cameras: none");
}

TEST_F(V4l2OpenTest, AnUnavailableFormatOrSizeListsTheAvailableOnes) {
  CameraSettings requested = settings();
  requested.format = CameraFormat::kUyvy;
  expect_refusal(requested, ErrorCode::kUnsupported,
                 "/dev/video0: uyvy 640x480 is not available (the driver set mjpg 640x480); the camera offers mjpg "
                 "640x480, 1280x720; yuyv 640x480, "
                 "320x240");
  requested.format = CameraFormat::kYuyv;
  requested.width_px = 1280;
  requested.height_px = 720;
  expect_refusal(requested, ErrorCode::kUnsupported,
                 "/dev/video0: yuyv 1280x720 is not available (the driver set yuyv 640x480); the camera offers mjpg "
                 "640x480, 1280x720; yuyv "
                 "640x480, 320x240");
  device_.formats = {{V4L2_PIX_FMT_NV12, {{32, 32}, {1920, 1080}}, true},
                     {V4L2_PIX_FMT_SBGGR10, {}, false},
                     {V4L2_PIX_FMT_H264, {}, false}};
  requested.format = CameraFormat::kRgb24;
  expect_refusal(requested, ErrorCode::kUnsupported,
                 "/dev/video0: rgb24 1280x720 is not available (the driver set nv12 1280x720); the camera offers nv12 "
                 "32x32 to 1920x1080; unsupported: BG10, H264");
  device_.fail(VIDIOC_S_FMT, EINVAL);
  expect_refusal(requested, ErrorCode::kUnsupported,
                 "/dev/video0: rgb24 1280x720 is not available (invalid argument); the camera offers nv12 32x32 to "
                 "1920x1080; unsupported: BG10, H264");
}

TEST_F(V4l2OpenTest, NegotiationErrorsAreReported) {
  device_.fail(VIDIOC_S_FMT, EBUSY);
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/video0: in use by another process; `fuser -v /dev/video0` shows it");
  device_.fail(VIDIOC_S_FMT, EIO);
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: cannot set a format: Input/output error");
  device_.fail(VIDIOC_S_FMT, ENODEV);
  expect_refusal(settings(), ErrorCode::kDisconnected, "/dev/video0: cannot set a format: No such device");
  device_.field = V4L2_FIELD_ALTERNATE;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: delivers single fields instead of frames at yuyv 640x480; try half the height");
}

TEST_F(V4l2OpenTest, AnotherFrameRateIsReported) {
  device_.rates_hz = {15, 30};
  V4l2Camera camera(settings());
  ASSERT_TRUE(camera.open().ok());
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 30.0);
  EXPECT_EQ(camera.info().negotiated, "/dev/video0: rate_hz = 60: set to 30");

  device_.reports_rate = false;
  ASSERT_TRUE(camera.open().ok());
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 0.0);
  EXPECT_EQ(camera.info().negotiated, "/dev/video0: rate_hz = 60: the driver does not report its frame rate");
}

TEST_F(V4l2OpenTest, FractionalRatesAreRequestedInMillihertz) {
  CameraSettings requested = settings();
  requested.rate_hz = 29.97;
  V4l2Camera camera(requested);
  ASSERT_TRUE(camera.open().ok());
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 30.0);
  EXPECT_EQ(camera.info().negotiated, "") << "29.97 Hz counts as 30 Hz";
}

TEST_F(V4l2OpenTest, AnotherNumberOfBuffersIsReported) {
  device_.max_buffers = 3;
  expect_negotiated(settings(), "/dev/video0: buffers = 4: set to 3");
  device_.max_buffers = 64;
  device_.min_buffers = 40;
  expect_negotiated(settings(), "/dev/video0: buffers = 4: set to 32");
  device_.min_buffers = device_.max_buffers = 1;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: the camera provides 1 buffers; at least 2 are needed");
}

TEST_F(V4l2OpenTest, BufferErrorsLeaveNothingMapped) {
  device_.fail(VIDIOC_REQBUFS, EBUSY);
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/video0: in use by another process; `fuser -v /dev/video0` shows it");
  device_.fail(VIDIOC_REQBUFS, ENOMEM);
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: mapping buffers failed: Cannot allocate memory");
  device_.fail(VIDIOC_QUERYBUF, EIO, 2);
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: mapping buffers failed: Input/output error");
  device_.maps = false;
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: mapping buffers failed: Invalid argument");
  device_.maps = true;
  device_.missing_bytes = 2;
  expect_refusal(settings(), ErrorCode::kUnsupported, "/dev/video0: a buffer has 614398 bytes, a picture needs 614400");
}

TEST_F(V4l2OpenTest, InterlacedPicturesAndOtherClocksAreReported) {
  device_.field = V4L2_FIELD_INTERLACED;
  device_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
  device_.rates_hz = {25};
  expect_negotiated(settings(),
                    "/dev/video0: rate_hz = 60: set to 25; interlaced: odd and even rows are half a frame apart; the "
                    "driver's time stamps are not from the monotonic clock: frames are stamped when they are dequeued");
}

TEST_F(V4l2OpenTest, InterruptedRequestsAreRepeated) {
  kernel_.interrupt_requests(5);
  expect_negotiated(settings(), "");
}

TEST_F(V4l2OpenTest, ACameraWithoutSupportedFormatsIsReported) {
  device_.formats = {{V4L2_PIX_FMT_SBGGR10P, {{2592, 1944}}, false}};
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: yuyv 640x480 is not available (the driver set pBAA 2592x1944); the camera offers no "
                 "format that Touchline supports; unsupported: pBAA");
  device_.formats = {{V4L2_PIX_FMT_UYVY, {}, false}};
  device_.fail(VIDIOC_S_FMT, EINVAL);
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: yuyv 640x480 is not available (invalid argument); the camera offers uyvy");
}

TEST_F(V4l2OpenTest, ALongListOfSizesIsReportedCompletely) {
  device_.formats = {{V4L2_PIX_FMT_RGB24, {}, false}, {V4L2_PIX_FMT_NV12, {}, false}, {V4L2_PIX_FMT_UYVY, {}, false}};
  for (fake::V4l2Format& format : device_.formats) {
    for (std::uint32_t i = 0; i < 100; ++i) format.sizes.emplace_back(1000 + i, 1000);
  }
  V4l2Camera camera(settings());
  const Result<void> opened = camera.open();
  EXPECT_EQ(opened.code(), ErrorCode::kUnsupported);
  const std::string begin =
      "/dev/video0: yuyv 640x480 is not available (the driver set rgb24 1000x1000); the camera offers rgb24 1000x1000, "
      "1001x1000, ";
  EXPECT_EQ(opened.text().substr(0, begin.size()), begin);
  EXPECT_NE(opened.text().find("uyvy 1000x1000"), std::string::npos);
  // At most 64 sizes per format are listed, because some drivers never end the list.
  EXPECT_TRUE(opened.text().ends_with("1063x1000")) << opened.text();
  EXPECT_GT(opened.text().size(), 2048u);
}

}  // namespace
}  // namespace touchline::testing
