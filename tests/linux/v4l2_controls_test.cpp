#include <cerrno>
#include <set>

#include "tests/linux/v4l2_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using V4l2ControlsTest = V4l2Test;
using hal::CameraSettings;
using hal::PowerLine;
using hal::V4l2Camera;

CameraSettings untouched(CameraSettings settings) {
  settings.exposure_us = settings.gain = settings.white_balance_k = 0;
  settings.power_line = PowerLine::kLeave;
  settings.focus = hal::kFocusUnset;
  return settings;
}

TEST_F(V4l2ControlsTest, SetsAllRequestedControlsAndReadsThemBack) {
  CameraSettings requested = settings();
  requested.exposure_us = 5000;
  requested.gain = 30;
  requested.white_balance_k = 4600;
  requested.power_line = PowerLine::k50Hz;
  requested.focus = 0;
  device_.controls[V4L2_CID_AUTOGAIN] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_AUTO] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 30};
  expect_negotiated(requested, "");
  const auto value = [&](std::uint32_t id) { return device_.controls.at(id).value; };
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO_PRIORITY), 0);
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 50);
  EXPECT_EQ(value(V4L2_CID_AUTOGAIN), 0);
  EXPECT_EQ(value(V4L2_CID_GAIN), 30);
  EXPECT_EQ(value(V4L2_CID_AUTO_WHITE_BALANCE), 0);
  EXPECT_EQ(value(V4L2_CID_WHITE_BALANCE_TEMPERATURE), 4600);
  EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 0);
  EXPECT_EQ(value(V4L2_CID_FOCUS_ABSOLUTE), 0);
  EXPECT_EQ(value(V4L2_CID_POWER_LINE_FREQUENCY), V4L2_CID_POWER_LINE_FREQUENCY_50HZ);
  for (const auto& [id, control] : device_.controls) EXPECT_GE(control.reads, control.writes) << id;
}

TEST_F(V4l2ControlsTest, UnsetControlsAreNotWritten) {
  expect_negotiated(untouched(settings()), "");
  for (const auto& [id, control] : device_.controls) {
    EXPECT_EQ(control.writes, id == V4L2_CID_EXPOSURE_AUTO_PRIORITY ? 1 : 0) << id;
  }
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO_PRIORITY).value, 0)
      << "the driver must not lower the frame rate";
}

// A camera keeps its flip controls over restarts.
TEST_F(V4l2ControlsTest, AMirroredPictureIsReported) {
  const char* const kMirrored =
      "/dev/video0: the camera mirrors the picture (vertical_flip is on), unless that undoes a mirror: robots' "
      "headings "
      "and turns would be reflected. Turn it off with v4l2-ctl --set-ctrl=vertical_flip=0; writing below the camera "
      "must be readable";
  device_.controls[V4L2_CID_HFLIP] = {0, 1, 1, 0};
  device_.controls[V4L2_CID_VFLIP] = {0, 1, 1, 1};
  expect_negotiated(untouched(settings()), kMirrored);
  device_.controls[V4L2_CID_HFLIP].value = 1;
  expect_negotiated(untouched(settings()), "");  // turned by 180 degrees
  device_.controls[V4L2_CID_VFLIP].value = 0;
  hal::V4l2Camera camera(untouched(settings()));
  ASSERT_TRUE(camera.open().ok());
  EXPECT_NE(camera.info().negotiated.find("horizontal_flip is on"), std::string::npos) << camera.info().negotiated;
}

TEST_F(V4l2ControlsTest, ARateReducedByTheExposureIsReported) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].ignores_writes = true;
  expect_negotiated(untouched(settings()),
                    "/dev/video0: rate_hz = 60: dynamic frame rate stays on (the driver did not change it)");
  device_.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].ignores_writes = false;
  CameraSettings requested = settings();
  requested.exposure_us = 16700;
  expect_negotiated(requested,
                    "/dev/video0: exposure of 16700 us: longer than a frame at 60 Hz, so fewer frames arrive");
}

TEST_F(V4l2ControlsTest, DriverSpecificExposureStepsAreSet) {
  device_.controls.erase(V4L2_CID_EXPOSURE_ABSOLUTE);
  device_.controls.erase(V4L2_CID_EXPOSURE_AUTO_PRIORITY);
  device_.controls[V4L2_CID_EXPOSURE_AUTO] = {0, 1, 1, V4L2_EXPOSURE_AUTO};
  device_.controls[V4L2_CID_EXPOSURE] = {0, 255, 1, 120};
  CameraSettings requested = untouched(settings());
  requested.exposure_us = 5000;
  expect_negotiated(requested,
                    "/dev/video0: exposure_us = 5000: the camera has driver-specific exposure steps, 0 to 255, instead "
                    "of microseconds: set exposure_steps");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).writes, 0) << "an arbitrary fixed exposure would be worse";
  requested.exposure_steps = 300;
  V4l2Camera camera(requested);
  ASSERT_TRUE(camera.open().ok());
  EXPECT_EQ(camera.info().negotiated, "/dev/video0: exposure_steps = 300: set to 255 (range 0 to 255, step 1)");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE).value, 255);
  EXPECT_NE(camera.info().description.find(", exposure 255 steps"), std::string::npos) << camera.info().description;
}

TEST_F(V4l2ControlsTest, MissingExposureStepsLeaveTheExposureAutomatic) {
  CameraSettings requested = untouched(settings());
  requested.exposure_steps = 100;
  expect_negotiated(requested, "/dev/video0: exposure_steps = 100: the camera has no such control");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).writes, 0);
}

TEST_F(V4l2ControlsTest, WhiteBalanceByGainsIsTheSameAtEachStart) {
  device_.controls.erase(V4L2_CID_WHITE_BALANCE_TEMPERATURE);
  fake::V4l2Control& red =
      device_.controls[V4L2_CID_RED_BALANCE] = {0, 255, 1, 77};  // left behind by automatic white balance
  fake::V4l2Control& blue = device_.controls[V4L2_CID_BLUE_BALANCE] = {0, 255, 1, 99};
  red.default_value = 140;
  blue.default_value = 130;
  const std::string message = "/dev/video0: white_balance_k = 4600: the camera has no color temperature, only gains: ";
  expect_negotiated(settings(), message + "red 140, blue 130");
  EXPECT_EQ(device_.controls.at(V4L2_CID_AUTO_WHITE_BALANCE).value, 0);
  EXPECT_EQ(red.value, 140);
  EXPECT_EQ(blue.value, 130);
  blue.set_error = EIO;
  expect_negotiated(settings(), message + "refused (Input/output error)");
}

TEST_F(V4l2ControlsTest, ShutterPriorityIsUsedIfManualExposureIsRefused) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO].refused_value = V4L2_EXPOSURE_MANUAL;
  expect_negotiated(settings(), "");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_SHUTTER_PRIORITY);
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
}

TEST_F(V4l2ControlsTest, ValuesOutsideTheRangeAreClampedAndReported) {
  CameraSettings requested = untouched(settings());
  requested.exposure_us = 300000;
  requested.gain = 1000;
  requested.white_balance_k = 4604;
  requested.focus = 12;
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 30};
  expect_negotiated(
      requested,
      "/dev/video0: exposure_us = 300000: set to 204700 (range 300 to 204700, step 100); gain = 1000: set to "
      "255 (range 0 to 255, step 1); white_balance_k = 4604: set to 4600 (range 2000 to 6500, step 10); "
      "focus = 12: set to 10 (range 0 to 250, step 5); exposure of 204700 us: longer than a frame at 60 Hz, so fewer "
      "frames arrive");
}

TEST_F(V4l2ControlsTest, ValuesAreLimitedToTheLastStepOfTheRange) {
  CameraSettings requested = untouched(settings());
  requested.white_balance_k = 7000;
  device_.controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE].high = 6507;
  expect_negotiated(requested, "/dev/video0: white_balance_k = 7000: set to 6500 (range 2000 to 6507, step 10)");
}

TEST_F(V4l2ControlsTest, ExposureIsRoundedTo100Microseconds) {
  CameraSettings requested = untouched(settings());
  requested.exposure_us = 5060;
  expect_negotiated(requested, "/dev/video0: exposure_us = 5060: set to 5100 (range 300 to 204700, step 100)");
}

TEST_F(V4l2ControlsTest, MissingControlsAreReported) {
  CameraSettings requested = settings();
  requested.gain = 10;
  requested.power_line = PowerLine::k60Hz;
  requested.focus = 0;
  device_.controls.clear();
  expect_negotiated(
      requested,
      "/dev/video0: power_line = 60hz: the camera has no such control; exposure_us = 5000: the camera has no "
      "such control; gain = 10: the camera has no such control; white_balance_k = 4600: the camera has no "
      "such control; focus = 0: the camera has no such "
      "control");
  requested = untouched(requested);
  requested.power_line = PowerLine::kOff;
  expect_negotiated(requested, "");
}

TEST_F(V4l2ControlsTest, DisabledControlsAreReportedAsMissing) {
  device_.controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE].flags = V4L2_CTRL_FLAG_DISABLED;
  expect_negotiated(settings(), "/dev/video0: white_balance_k = 4600: the camera has no such control");
}

TEST_F(V4l2ControlsTest, RefusedControlsAreReportedAndTheCameraOpens) {
  CameraSettings requested = settings();
  requested.power_line = PowerLine::k50Hz;
  device_.controls[V4L2_CID_EXPOSURE_AUTO].set_error = EBUSY;
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].set_error = EIO;
  device_.controls[V4L2_CID_AUTO_WHITE_BALANCE].ignores_writes = true;
  device_.controls[V4L2_CID_POWER_LINE_FREQUENCY].ignores_writes = true;
  expect_negotiated(
      requested,
      "/dev/video0: power_line = 50hz: the driver kept another value; exposure_us = 5000: automatic exposure stays "
      "on (Device or resource busy); exposure_us = 5000: refused (Input/output error); white_balance_k = "
      "4600: automatic white balance stays on (the driver did not change it)");
}

TEST_F(V4l2ControlsTest, GainFallsBackToTheAnalogueGain) {
  CameraSettings requested = untouched(settings());
  requested.gain = 12;
  device_.controls.erase(V4L2_CID_GAIN);
  device_.controls[V4L2_CID_ANALOGUE_GAIN] = {1, 16, 1, 1};
  expect_negotiated(requested, "");
  EXPECT_EQ(device_.controls.at(V4L2_CID_ANALOGUE_GAIN).value, 12);
}

TEST_F(V4l2ControlsTest, ControlsAreSetAgainAtTheStart) {
  device_.forgets_controls_at_start = true;
  V4l2Camera camera(settings());
  ASSERT_TRUE(camera.open().ok());
  ASSERT_TRUE(camera.start().ok());
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
  camera.stop();
}

TEST_F(V4l2ControlsTest, StartDoesNotRepeatTheReport) {
  device_.rates_hz = {30};
  CameraSettings requested = settings();
  requested.gain = 300;
  V4l2Camera camera(requested);
  ASSERT_TRUE(camera.open().ok());
  const std::string report = camera.info().negotiated;
  EXPECT_EQ(report, "/dev/video0: rate_hz = 60: set to 30; gain = 300: set to 255 (range 0 to 255, step 1)");
  ASSERT_TRUE(camera.start().ok());
  EXPECT_EQ(camera.info().negotiated, report);
}

using V4l2AdjustTest = V4l2RunningTest;

TEST_F(V4l2AdjustTest, ControlsChangeWhileStreamingWithoutALostFrame) {
  begin();
  expect_frame(*camera_, 0);
  CameraSettings requested = settings();
  requested.exposure_us = 4000;
  requested.gain = 1000;
  requested.rate_hz = 7.0;
  const std::string negotiated = camera_->info().negotiated;
  EXPECT_EQ(negotiated_by(camera_->adjust(requested)), "/dev/video0: gain = 1000: set to 255 (range 0 to 255, step 1)");
  EXPECT_EQ(camera_->info().negotiated, negotiated) << "the thread that waits for frames may read it at the same time";
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 40);
  EXPECT_EQ(device_.controls.at(V4L2_CID_GAIN).value, 255);
  EXPECT_TRUE(device_.streaming());
  const Result<hal::FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok()) << frame.text();
  EXPECT_EQ(frame.value().frame().sequence, 1u);
  // V4L2 time stamps are whole microseconds.
  const Duration into_exposure = frame.value().frame().capture_time - device_.start_of_exposure(1);
  EXPECT_NEAR(seconds(into_exposure), 0.002, 1e-6) << "the middle of the new exposure time";
}

TEST_F(V4l2AdjustTest, UnchangedControlsAreNotWritten) {
  device_.controls[V4L2_CID_AUTOGAIN] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 30};
  CameraSettings requested = settings();
  requested.gain = 10;
  requested.focus = 20;
  begin(requested);
  const auto written_by = [&](const CameraSettings& next) {
    for (auto& [id, control] : device_.controls) control.writes = 0;
    EXPECT_EQ(negotiated_by(camera_->adjust(next)), "");
    std::set<std::uint32_t> written;
    for (const auto& [id, control] : device_.controls) {
      if (control.writes > 0) written.insert(id);
    }
    return written;
  };
  using Controls = std::set<std::uint32_t>;
  EXPECT_EQ(written_by(requested), Controls{});
  requested.gain = 12;
  EXPECT_EQ(written_by(requested), Controls{V4L2_CID_GAIN});
  requested.exposure_us = 4000;
  EXPECT_EQ(written_by(requested), Controls{V4L2_CID_EXPOSURE_ABSOLUTE});
  requested.power_line = PowerLine::k50Hz;
  EXPECT_EQ(written_by(requested), (Controls{V4L2_CID_POWER_LINE_FREQUENCY, V4L2_CID_EXPOSURE_ABSOLUTE}))
      << "the flicker filter may limit the exposure times";
  device_.controls[V4L2_CID_AUTOGAIN].value = 1;
  requested.gain = 14;
  EXPECT_EQ(written_by(requested), (Controls{V4L2_CID_GAIN, V4L2_CID_AUTOGAIN})) << "another program has turned it on";
}

TEST_F(V4l2AdjustTest, ChangesPersistAfterReopening) {
  begin();
  CameraSettings requested = settings();
  requested.exposure_us = 4000;
  camera_->close();
  EXPECT_EQ(negotiated_by(camera_->adjust(requested)), "");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50) << "a closed camera is not changed";
  ASSERT_OK(camera_->open());
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 40);
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 999;
  ASSERT_OK(camera_->start());
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 40);
}

TEST_F(V4l2AdjustTest, AnUnpluggedCameraIsNotReportedAsLackingControls) {
  begin();
  device_.unplug();
  CameraSettings requested = untouched(settings());
  requested.power_line = PowerLine::k50Hz;
  EXPECT_EQ(negotiated_by(camera_->adjust(requested)),
            "/dev/video0: the camera went away; the values are set when it is reopened");
}

TEST_F(V4l2ControlsTest, ControlsAreSetAtEveryOpen) {
  V4l2Camera camera(settings());
  for (int i = 0; i < 2; ++i) {
    device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 999;
    ASSERT_TRUE(camera.open().ok());
    EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
    camera.close();
  }
}

}  // namespace
}  // namespace touchline::testing
