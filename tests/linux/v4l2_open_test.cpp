#include <cerrno>

#include "tests/linux/v4l2_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using V4l2OpenTest = V4l2Test;
using hal::CameraFormat;
using hal::CameraSettings;
using hal::V4l2Camera;

TEST_F(V4l2OpenTest, GrantsWhatIsAskedAndHasNothingToSay) {
  V4l2Camera camera(settings());
  ASSERT_OK(camera.open());
  EXPECT_EQ(camera.info().negotiated, "");
  EXPECT_EQ(camera.info().format, PixelFormat::kYuyv);
  EXPECT_EQ(camera.info().width_px, 640);
  EXPECT_EQ(camera.info().height_px, 480);
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 60.0);
  EXPECT_EQ(device_.mapped(), 4u);
  EXPECT_EQ(
      camera.info().description,
      "/dev/video0 (Fake Camera, usb-0000:00:14.0-1): yuyv 640x480 at 60 Hz, 4 buffers mapped and shared as "
      "dma-bufs, stamps of the start of exposure, exposure 5000 us, gain 64, white balance 4600 K, power line 60 Hz");
  camera.close();
  EXPECT_EQ(device_.mapped(), 0u);
  EXPECT_EQ(kernel_.open_files(), 0u);
}

TEST_F(V4l2OpenTest, OpensAgainAfterCloseAndWithoutClose) {
  V4l2Camera camera(settings());
  for (int i = 0; i < 3; ++i) {
    ASSERT_OK(camera.open());
    ASSERT_OK(camera.open());
    EXPECT_EQ(kernel_.open_files(), 1u + 4u) << "and a dma-buf a buffer";
    camera.close();
  }
}

TEST_F(V4l2OpenTest, MissingDeviceListsTheCamerasThatAreHere) {
  kernel_.remove("/dev/video0");
  expect_refusal(settings(), ErrorCode::kNotFound, "/dev/video0: no such device; cameras here: none");

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
                 "/dev/video0: no such device; cameras here: /dev/video2 (HD Webcam, usb-0000:00:14.0-4) = "
                 "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:4:1.0-video-index0, "
                 "/dev/video11 (Fake Camera, usb-0000:00:14.0-1), /dev/video12 (Fake Camera, usb-0000:00:14.0-1)");
}

TEST_F(V4l2OpenTest, OpensByItsStableName) {
  constexpr const char* kByPath = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0";
  CameraSettings asked = settings();
  asked.device = kByPath;
  expect_refusal(
      asked, ErrorCode::kNotFound,
      std::string(kByPath) + ": no such device; cameras here: /dev/video0 (Fake Camera, usb-0000:00:14.0-1)");
  kernel_.link(kByPath, "/dev/video0");
  expect_negotiated(asked, "");
}

TEST_F(V4l2OpenTest, ANumberIsPointedOutWhereALinkWouldStay) {
  kernel_.link("/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0", "/dev/video0");
  kernel_.link("/dev/goal-camera", "/dev/video0");
  expect_negotiated(settings(),
                    "/dev/video0: device = \"/dev/video0\": a number, which the order of plugging in decides; "
                    "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0 is the same camera");
  CameraSettings asked = settings();
  asked.device = "/dev/goal-camera";
  expect_negotiated(asked, "");
}

TEST_F(V4l2OpenTest, WhatIsGrantedIsSaidAsItIs) {
  device_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  device_.exports = false;
  device_.tells_rate = false;
  device_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  device_.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  device_.controls[V4L2_CID_FOCUS_AUTO] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 0};
  CameraSettings asked = settings();
  asked.exposure_us = asked.white_balance_k = 0;
  V4l2Camera camera(asked);
  ASSERT_TRUE(camera.open().ok());
  EXPECT_EQ(
      camera.info().negotiated,
      "/dev/video0: rate_hz = 60: the driver does not tell its rate; YUV of full range: its darkest 16 levels are "
      "taken for black");
  EXPECT_EQ(
      camera.info().description,
      "/dev/video0 (Fake Camera, usb-0000:00:14.0-1): yuyv 640x480, 4 buffers mapped (multi-planar), stamps of the "
      "end of frame, exposure automatic, gain 64, white balance automatic, focus automatic, power line 60 Hz");
}

TEST_F(V4l2OpenTest, RefusedAccessSaysWhatToDo) {
  kernel_.refuse_open("/dev/video0", EACCES);
  expect_refusal(settings(), ErrorCode::kPermission,
                 "/dev/video0: permission denied; add the user to the group video (`sudo usermod -aG video $USER`) and "
                 "log in again");
  kernel_.refuse_open("/dev/video0", EBUSY);
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/video0: held by another process; `fuser -v /dev/video0` names it");
  kernel_.refuse_open("/dev/video0", EMFILE);
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: cannot be opened: Too many open files");
}

TEST_F(V4l2OpenTest, DevicesThatAreNoCameras) {
  device_.fail(VIDIOC_QUERYCAP, ENOTTY);
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: not a video device; cameras here: /dev/video0 (Fake Camera, usb-0000:00:14.0-1)");
  device_.fail(VIDIOC_QUERYCAP, ENODEV);
  expect_refusal(settings(), ErrorCode::kDisconnected, "/dev/video0: the camera went away (asking what it is)");

  device_.capabilities = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0 (Fake Camera): does not capture video; cameras here: none");
  device_.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_READWRITE;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0 (Fake Camera): cannot stream into mapped buffers; cameras here: none");
}

TEST_F(V4l2OpenTest, AnotherFormatOrSizeIsRefusedWithTheListOfWhatThereIs) {
  CameraSettings asked = settings();
  asked.format = CameraFormat::kUyvy;
  expect_refusal(asked, ErrorCode::kUnsupported,
                 "/dev/video0: no uyvy 640x480 but mjpg 640x480; it offers mjpg 640x480, 1280x720; yuyv 640x480, "
                 "320x240");
  asked.format = CameraFormat::kYuyv;
  asked.width_px = 1280;
  asked.height_px = 720;
  expect_refusal(asked, ErrorCode::kUnsupported,
                 "/dev/video0: no yuyv 1280x720 but yuyv 640x480; it offers mjpg 640x480, 1280x720; yuyv "
                 "640x480, 320x240");
  device_.formats = {{V4L2_PIX_FMT_NV12, {{32, 32}, {1920, 1080}}, true},
                     {V4L2_PIX_FMT_SBGGR10, {}, false},
                     {V4L2_PIX_FMT_H264, {}, false}};
  asked.format = CameraFormat::kRgb24;
  expect_refusal(asked, ErrorCode::kUnsupported,
                 "/dev/video0: no rgb24 1280x720 but nv12 1280x720; it offers nv12 32x32 to 1920x1080; besides, BG10, "
                 "H264, which cannot be read");
  device_.fail(VIDIOC_S_FMT, EINVAL);
  expect_refusal(asked, ErrorCode::kUnsupported,
                 "/dev/video0: no rgb24 1280x720 (invalid argument); it offers nv12 32x32 to 1920x1080; besides, BG10, "
                 "H264, which cannot be read");
}

TEST_F(V4l2OpenTest, FailuresWhileNegotiating) {
  device_.fail(VIDIOC_S_FMT, EBUSY);
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/video0: held by another process; `fuser -v /dev/video0` names it");
  device_.fail(VIDIOC_S_FMT, EIO);
  expect_refusal(settings(), ErrorCode::kIo, "/dev/video0: cannot set a format: Input/output error");
  device_.fail(VIDIOC_S_FMT, ENODEV);
  expect_refusal(settings(), ErrorCode::kDisconnected, "/dev/video0: cannot set a format: No such device");
  device_.field = V4L2_FIELD_ALTERNATE;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: delivers single fields, not whole frames, at yuyv 640x480; half the height may be "
                 "progressive");
}

TEST_F(V4l2OpenTest, RateIsReportedWhenItIsNotTheOneAsked) {
  device_.rates_hz = {15, 30};
  V4l2Camera camera(settings());
  ASSERT_TRUE(camera.open().ok());
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 30.0);
  EXPECT_EQ(camera.info().negotiated, "/dev/video0: rate_hz = 60: set to 30");

  device_.tells_rate = false;
  ASSERT_TRUE(camera.open().ok());
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 0.0);
  EXPECT_EQ(camera.info().negotiated, "/dev/video0: rate_hz = 60: the driver does not tell its rate");
}

TEST_F(V4l2OpenTest, FractionalRateIsAskedInMillihertz) {
  CameraSettings asked = settings();
  asked.rate_hz = 29.97;
  V4l2Camera camera(asked);
  ASSERT_TRUE(camera.open().ok());
  EXPECT_DOUBLE_EQ(camera.info().rate_hz, 30.0);
  EXPECT_EQ(camera.info().negotiated, "") << "29.97 is 30 to a person";
}

TEST_F(V4l2OpenTest, BuffersFewerOrMoreThanAskedAreReported) {
  device_.most_buffers = 3;
  expect_negotiated(settings(), "/dev/video0: buffers = 4: set to 3");
  device_.most_buffers = 64;
  device_.fewest_buffers = 40;
  expect_negotiated(settings(), "/dev/video0: buffers = 4: set to 32");
  device_.fewest_buffers = device_.most_buffers = 1;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: the camera provides 1 buffers; at least 2 are needed");
}

TEST_F(V4l2OpenTest, FailuresOfBuffersLeaveNothingBehind) {
  device_.fail(VIDIOC_REQBUFS, EBUSY);
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/video0: held by another process; `fuser -v /dev/video0` names it");
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

TEST_F(V4l2OpenTest, InterlacedPicturesAndForeignClocksAreReportedTogether) {
  device_.field = V4L2_FIELD_INTERLACED;
  device_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
  device_.rates_hz = {25};
  expect_negotiated(settings(),
                    "/dev/video0: rate_hz = 60: set to 25; interlaced: odd and even rows are half a frame apart; the "
                    "driver's time stamps are of no monotonic clock: frames are stamped when they are fetched");
}

TEST_F(V4l2OpenTest, SignalsDoNotDisturb) {
  kernel_.interrupt_requests(5);
  expect_negotiated(settings(), "");
}

TEST_F(V4l2OpenTest, ACameraWithNothingThatCanBeReadSaysSo) {
  device_.formats = {{V4L2_PIX_FMT_SBGGR10P, {{2592, 1944}}, false}};
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: no yuyv 640x480 but pBAA 2592x1944; it offers nothing that can be read; besides, pBAA, "
                 "which cannot be read");
  device_.formats = {{V4L2_PIX_FMT_UYVY, {}, false}};
  device_.fail(VIDIOC_S_FMT, EINVAL);
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/video0: no yuyv 640x480 (invalid argument); it offers uyvy");
}

TEST_F(V4l2OpenTest, ALongListOfSizesIsReportedWhole) {
  device_.formats = {{V4L2_PIX_FMT_RGB24, {}, false}, {V4L2_PIX_FMT_NV12, {}, false}, {V4L2_PIX_FMT_UYVY, {}, false}};
  for (fake::V4l2Format& format : device_.formats) {
    for (std::uint32_t i = 0; i < 100; ++i) format.sizes.emplace_back(1000 + i, 1000);
  }
  V4l2Camera camera(settings());
  const Result<void> opened = camera.open();
  EXPECT_EQ(opened.code(), ErrorCode::kUnsupported);
  const std::string begin = "/dev/video0: no yuyv 640x480 but rgb24 1000x1000; it offers rgb24 1000x1000, 1001x1000, ";
  EXPECT_EQ(opened.text().substr(0, begin.size()), begin);
  EXPECT_NE(opened.text().find("uyvy 1000x1000"), std::string::npos);
  // Drivers that never end a list are cut off after 64 sizes per format.
  EXPECT_TRUE(opened.text().ends_with("1063x1000")) << opened.text();
  EXPECT_GT(opened.text().size(), 2048u);
}

}  // namespace
}  // namespace touchline::testing
