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
  settings.focus = hal::kFocusLeave;
  return settings;
}

TEST_F(V4l2ControlsTest, FixesAllThatIsAskedAndReadsItBack) {
  CameraSettings asked = settings();
  asked.exposure_us = 5000;
  asked.gain = 30;
  asked.white_balance_k = 4600;
  asked.power_line = PowerLine::k50Hz;
  asked.focus = 0;
  device_.controls[V4L2_CID_AUTOGAIN] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_AUTO] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 30};
  expect_negotiated(asked, "");
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

TEST_F(V4l2ControlsTest, ZeroLeavesTheDriverAlone) {
  expect_negotiated(untouched(settings()), "");
  for (const auto& [id, control] : device_.controls) {
    EXPECT_EQ(control.writes, id == V4L2_CID_EXPOSURE_AUTO_PRIORITY ? 1 : 0) << id;
  }
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO_PRIORITY).value, 0) << "the rate is not the driver's";
}

TEST_F(V4l2ControlsTest, ARateThatGivesWayToTheExposureIsTold) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].stubborn = true;
  expect_negotiated(untouched(settings()),
                    "/dev/video0: rate_hz = 60: exposure before frame rate stays on (the driver kept it)");
  device_.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].stubborn = false;
  CameraSettings asked = settings();
  asked.exposure_us = 16700;
  expect_negotiated(asked, "/dev/video0: exposure of 16700 us: longer than a frame at 60 Hz, so fewer frames come");
}

TEST_F(V4l2ControlsTest, ACameraThatCountsExposureInItsOwnStepsIsSetInThem) {
  device_.controls.erase(V4L2_CID_EXPOSURE_ABSOLUTE);
  device_.controls.erase(V4L2_CID_EXPOSURE_AUTO_PRIORITY);
  device_.controls[V4L2_CID_EXPOSURE_AUTO] = {0, 1, 1, V4L2_EXPOSURE_AUTO};
  device_.controls[V4L2_CID_EXPOSURE] = {0, 255, 1, 120};
  CameraSettings asked = untouched(settings());
  asked.exposure_us = 5000;
  expect_negotiated(
      asked,
      "/dev/video0: exposure_us = 5000: the camera counts exposure in steps of its own, 0 to 255, and not in "
      "time: exposure_steps fixes it");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).writes, 0) << "fixed at what nobody chose, it would be worse";
  asked.exposure_steps = 300;
  V4l2Camera camera(asked);
  ASSERT_TRUE(camera.open().ok());
  EXPECT_EQ(camera.info().negotiated, "/dev/video0: exposure_steps = 300: set to 255 (range 0 to 255, step 1)");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE).value, 255);
  EXPECT_NE(camera.info().description.find(", exposure 255 steps"), std::string::npos) << camera.info().description;
}

TEST_F(V4l2ControlsTest, ExposureStepsThatACameraLacksLeaveItAutomatic) {
  CameraSettings asked = untouched(settings());
  asked.exposure_steps = 100;
  expect_negotiated(asked, "/dev/video0: exposure_steps = 100: the camera has no such control");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).writes, 0);
}

TEST_F(V4l2ControlsTest, WhiteBalanceByGainsIsTheSameAtEachStart) {
  device_.controls.erase(V4L2_CID_WHITE_BALANCE_TEMPERATURE);
  fake::V4l2Control& red = device_.controls[V4L2_CID_RED_BALANCE] = {0, 255, 1, 77};  // as the automatic left it
  fake::V4l2Control& blue = device_.controls[V4L2_CID_BLUE_BALANCE] = {0, 255, 1, 99};
  red.normal = 140;
  blue.normal = 130;
  const std::string said = "/dev/video0: white_balance_k = 4600: the camera takes gains only: ";
  expect_negotiated(settings(), said + "red 140, blue 130");
  EXPECT_EQ(device_.controls.at(V4L2_CID_AUTO_WHITE_BALANCE).value, 0);
  EXPECT_EQ(red.value, 140);
  EXPECT_EQ(blue.value, 130);
  blue.set_error = EIO;
  expect_negotiated(settings(), said + "refused (Input/output error)");
}

TEST_F(V4l2ControlsTest, ShutterPriorityFixesTheTimeWhereNothingElseDoes) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO].refuses = V4L2_EXPOSURE_MANUAL;
  expect_negotiated(settings(), "");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_SHUTTER_PRIORITY);
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
}

TEST_F(V4l2ControlsTest, ValuesOutsideTheRangeAreClampedAndReported) {
  CameraSettings asked = untouched(settings());
  asked.exposure_us = 300000;
  asked.gain = 1000;
  asked.white_balance_k = 4604;
  asked.focus = 12;
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 30};
  expect_negotiated(
      asked,
      "/dev/video0: exposure_us = 300000: set to 204700 (range 300 to 204700, step 100); gain = 1000: set to "
      "255 (range 0 to 255, step 1); white_balance_k = 4604: set to 4600 (range 2000 to 6500, step 10); "
      "focus = 12: set to 10 (range 0 to 250, step 5); exposure of 204700 us: longer than a frame at 60 Hz, so fewer "
      "frames come");
}

TEST_F(V4l2ControlsTest, ARangeThatDoesNotEndOnAStepIsUsedToItsLastStep) {
  CameraSettings asked = untouched(settings());
  asked.white_balance_k = 7000;
  device_.controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE].high = 6507;
  expect_negotiated(asked, "/dev/video0: white_balance_k = 7000: set to 6500 (range 2000 to 6507, step 10)");
}

TEST_F(V4l2ControlsTest, ExposureIsRoundedToTheDriversHundredMicroseconds) {
  CameraSettings asked = untouched(settings());
  asked.exposure_us = 5060;
  expect_negotiated(asked, "/dev/video0: exposure_us = 5060: set to 5100 (range 300 to 204700, step 100)");
}

TEST_F(V4l2ControlsTest, LackingControlsAreNamed) {
  CameraSettings asked = settings();
  asked.gain = 10;
  asked.power_line = PowerLine::k60Hz;
  asked.focus = 0;
  device_.controls.clear();
  expect_negotiated(
      asked,
      "/dev/video0: power_line = 60hz: the camera has no such control; exposure_us = 5000: the camera has no "
      "such control; gain = 10: the camera has no such control; white_balance_k = 4600: the camera has no "
      "such control; focus = 0: the camera has no such "
      "control");
  asked = untouched(asked);
  asked.power_line = PowerLine::kOff;
  expect_negotiated(asked, "");
}

TEST_F(V4l2ControlsTest, DisabledControlsCountAsLacking) {
  device_.controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE].flags = V4L2_CTRL_FLAG_DISABLED;
  expect_negotiated(settings(), "/dev/video0: white_balance_k = 4600: the camera has no such control");
}

TEST_F(V4l2ControlsTest, RefusedControlsAreReportedAndTheCameraOpens) {
  CameraSettings asked = settings();
  asked.power_line = PowerLine::k50Hz;
  device_.controls[V4L2_CID_EXPOSURE_AUTO].set_error = EBUSY;
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].set_error = EIO;
  device_.controls[V4L2_CID_AUTO_WHITE_BALANCE].stubborn = true;
  device_.controls[V4L2_CID_POWER_LINE_FREQUENCY].stubborn = true;
  expect_negotiated(
      asked,
      "/dev/video0: power_line = 50hz: the driver kept another; exposure_us = 5000: automatic exposure stays "
      "on (Device or resource busy); exposure_us = 5000: refused (Input/output error); white_balance_k = "
      "4600: automatic white balance stays on (the driver kept it)");
}

TEST_F(V4l2ControlsTest, GainFallsBackToTheSensorsOwn) {
  CameraSettings asked = untouched(settings());
  asked.gain = 12;
  device_.controls.erase(V4L2_CID_GAIN);
  device_.controls[V4L2_CID_ANALOGUE_GAIN] = {1, 16, 1, 1};
  expect_negotiated(asked, "");
  EXPECT_EQ(device_.controls.at(V4L2_CID_ANALOGUE_GAIN).value, 12);
}

TEST_F(V4l2ControlsTest, AreSetAgainWhenTheStreamBegins) {
  device_.forgets_controls_at_start = true;
  V4l2Camera camera(settings());
  ASSERT_TRUE(camera.open().ok());
  ASSERT_TRUE(camera.start().ok());
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50);
  camera.stop();
}

TEST_F(V4l2ControlsTest, AReportIsNotRepeatedByStart) {
  device_.rates_hz = {30};
  CameraSettings asked = settings();
  asked.gain = 300;
  V4l2Camera camera(asked);
  ASSERT_TRUE(camera.open().ok());
  const std::string report = camera.info().negotiated;
  EXPECT_EQ(report, "/dev/video0: rate_hz = 60: set to 30; gain = 300: set to 255 (range 0 to 255, step 1)");
  ASSERT_TRUE(camera.start().ok());
  EXPECT_EQ(camera.info().negotiated, report);
}

using V4l2AdjustTest = V4l2RunningTest;

TEST_F(V4l2AdjustTest, ChangesWhatTheStreamShowsWithoutAFrameLost) {
  begin();
  expect_frame(*camera_, 0);
  CameraSettings asked = settings();
  asked.exposure_us = 4000;
  asked.gain = 1000;
  asked.rate_hz = 7.0;
  const std::string negotiated = camera_->info().negotiated;
  EXPECT_EQ(negotiated_by(camera_->adjust(asked)), "/dev/video0: gain = 1000: set to 255 (range 0 to 255, step 1)");
  EXPECT_EQ(camera_->info().negotiated, negotiated) << "the thread that waits for frames may be reading it";
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 40);
  EXPECT_EQ(device_.controls.at(V4L2_CID_GAIN).value, 255);
  EXPECT_TRUE(device_.streaming());
  const Result<hal::FrameLease> frame = camera_->wait(soon());
  ASSERT_TRUE(frame.ok()) << frame.text();
  EXPECT_EQ(frame.value().frame().sequence, 1u);
  // V4L2 stamps in whole microseconds.
  const Duration into_exposure = frame.value().frame().capture_time - device_.start_of_exposure(1);
  EXPECT_NEAR(seconds(into_exposure), 0.002, 1e-6) << "the middle of the new exposure time";
}

TEST_F(V4l2AdjustTest, WritesNothingThatDoesNotChange) {
  device_.controls[V4L2_CID_AUTOGAIN] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_FOCUS_ABSOLUTE] = {0, 250, 5, 30};
  CameraSettings asked = settings();
  asked.gain = 10;
  asked.focus = 20;
  begin(asked);
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
  EXPECT_EQ(written_by(asked), Controls{});
  asked.gain = 12;
  EXPECT_EQ(written_by(asked), Controls{V4L2_CID_GAIN});
  asked.exposure_us = 4000;
  EXPECT_EQ(written_by(asked), Controls{V4L2_CID_EXPOSURE_ABSOLUTE});
  asked.power_line = PowerLine::k50Hz;
  EXPECT_EQ(written_by(asked), (Controls{V4L2_CID_POWER_LINE_FREQUENCY, V4L2_CID_EXPOSURE_ABSOLUTE}))
      << "which exposures there are may depend on it";
  device_.controls[V4L2_CID_AUTOGAIN].value = 1;
  asked.gain = 14;
  EXPECT_EQ(written_by(asked), (Controls{V4L2_CID_GAIN, V4L2_CID_AUTOGAIN})) << "somebody has switched it on";
}

TEST_F(V4l2AdjustTest, HoldsWhenTheCameraIsOpenedAgain) {
  begin();
  CameraSettings asked = settings();
  asked.exposure_us = 4000;
  camera_->close();
  EXPECT_EQ(negotiated_by(camera_->adjust(asked)), "");
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 50) << "a closed camera is not touched";
  ASSERT_OK(camera_->open());
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 40);
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 999;
  ASSERT_OK(camera_->start());
  EXPECT_EQ(device_.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value, 40);
}

TEST_F(V4l2AdjustTest, ACameraThatIsGoneLacksNoControl) {
  begin();
  device_.plug_out();
  CameraSettings asked = untouched(settings());
  asked.power_line = PowerLine::k50Hz;
  EXPECT_EQ(negotiated_by(camera_->adjust(asked)), "/dev/video0: the camera went away; its next opening sets them");
}

TEST_F(V4l2ControlsTest, EveryReopeningSetsThemAnew) {
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
