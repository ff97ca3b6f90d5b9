#include "hal/linux/libcamera/libcamera_controls.h"

#include <gtest/gtest.h>

namespace touchline::hal {
namespace {

using enum LibcameraControl;

/// The control ranges of a Raspberry Pi's camera.
LibcameraLimits limits() {
  LibcameraLimits limits;
  const auto add = [&](LibcameraControl control, double low, double high) {
    limits.low[control] = low;
    limits.high[control] = high;
  };
  add(kExposure, 75.0, 11766829.0);
  add(kGain, 1.0, 10.6);
  add(kRedGain, 0.0, 32.0);
  add(kBlueGain, 0.0, 32.0);
  add(kFlickerPeriod, 100.0, 1000000.0);
  add(kFrameDuration, 16971.0, 11767556.0);
  add(kLensPosition, 0.0, 32.0);
  return limits;
}

CameraSettings settings() {
  CameraSettings settings;
  settings.exposure_us = 5000;
  settings.gain = 250;
  settings.white_balance_k = 4600;
  settings.power_line = PowerLine::k50Hz;
  settings.rate_hz = 30.0;
  settings.focus = 50;
  return settings;
}

TEST(LibcameraControls, SettingsBecomeControls) {
  LibcameraLimits camera = limits();
  camera.low[kTemperature] = 100.0;
  camera.high[kTemperature] = 100000.0;
  ErrorText negotiated;
  LibcameraNumbers controls = controls_for(settings(), camera, negotiated);
  EXPECT_EQ(negotiated.str(), "");
  EXPECT_EQ(controls[kExposureManual], 1.0);
  EXPECT_EQ(controls[kExposure], 5000.0);
  EXPECT_EQ(controls[kGainManual], 1.0);
  EXPECT_EQ(controls[kGain], 2.5);
  EXPECT_EQ(controls[kWhiteBalanceManual], 1.0);
  EXPECT_EQ(controls[kTemperature], 4600.0);
  EXPECT_FALSE(controls[kRedGain]);
  EXPECT_EQ(controls[kFlickerManual], 1.0);
  EXPECT_EQ(controls[kFlickerPeriod], 10000.0);
  EXPECT_DOUBLE_EQ(*controls[kFrameDuration], 1e6 / 30.0);
  EXPECT_EQ(controls[kFocusManual], 1.0);
  EXPECT_EQ(controls[kLensPosition], 0.5);
  ErrorText text;
  describe_controls(controls, text);
  EXPECT_EQ(text.str(), ", exposure 5000 us, gain 250, white balance 4600 K, focus 50");

  CameraSettings requested = settings();
  requested.power_line = PowerLine::k60Hz;
  EXPECT_DOUBLE_EQ(*controls_for(requested, camera, negotiated)[kFlickerPeriod], 1e6 / 120.0);
  requested.power_line = PowerLine::kOff;
  EXPECT_EQ(controls_for(requested, camera, negotiated)[kFlickerManual], 0.0);
}

TEST(LibcameraControls, UnsetControlsAreNotChanged) {
  CameraSettings requested;  // focus is not set by default
  requested.exposure_us = requested.gain = requested.white_balance_k = 0;
  requested.rate_hz = 0.0;
  ErrorText negotiated;
  const LibcameraNumbers controls = controls_for(requested, limits(), negotiated);
  for (std::size_t i = 0; i < kLibcameraControls; ++i) EXPECT_FALSE(controls[static_cast<LibcameraControl>(i)]) << i;
  EXPECT_EQ(negotiated.str(), "");
}

TEST(LibcameraControls, ACameraWithoutTemperatureGetsTheGainsOfACommonSensor) {
  ErrorText negotiated;
  CameraSettings requested = settings();
  requested.white_balance_k = 5600;
  LibcameraNumbers controls = controls_for(requested, limits(), negotiated);
  EXPECT_EQ(controls[kWhiteBalanceManual], 1.0);
  EXPECT_NEAR(*controls[kRedGain], 2.2, 1e-9);
  EXPECT_NEAR(*controls[kBlueGain], 1.86, 1e-9);
  requested.white_balance_k = 2500;  // warm light needs less red
  controls = controls_for(requested, limits(), negotiated);
  EXPECT_NEAR(*controls[kRedGain], 1.07, 0.02);
  EXPECT_NEAR(*controls[kBlueGain], 2.78, 0.02);
  report_negotiated(requested, limits(), controls, controls, negotiated);
  EXPECT_EQ(negotiated.str(),
            "white_balance_k = 2500: the camera has no color temperature, only gains: red 1.06, blue 2.78");
}

TEST(LibcameraControls, MissingControlsAreReported) {
  ErrorText negotiated;
  const LibcameraNumbers controls = controls_for(settings(), {}, negotiated);
  report_negotiated(settings(), {}, controls, {}, negotiated);
  EXPECT_EQ(negotiated.str(),
            "exposure_us = 5000: the camera has no such control; gain = 250: the camera has no such control; "
            "white_balance_k = 4600: the camera has no such control; focus = 50: the camera has no such control; "
            "power_line = 50hz: the camera has no such control; "
            "rate_hz = 30: the camera does not report its frame rate");
  negotiated.clear();
  CameraSettings requested = settings();
  requested.power_line = PowerLine::kOff;  // no filter is requested
  requested.exposure_us = requested.gain = requested.white_balance_k = 0;
  requested.focus = kFocusUnset;
  EXPECT_FALSE(controls_for(requested, {}, negotiated)[kFlickerManual]);
  EXPECT_EQ(negotiated.str(), "");
  requested.exposure_steps = 40;
  static_cast<void>(controls_for(requested, {}, negotiated));
  EXPECT_EQ(negotiated.str(), "exposure_steps = 40: the camera has no such control");
}

TEST(LibcameraControls, DifferencesAreReportedInUnitsOfTheKeys) {
  CameraSettings requested = settings();
  requested.gain = 2000;
  requested.rate_hz = 120.0;
  requested.white_balance_k = 0;
  ErrorText negotiated;
  const LibcameraNumbers controls = controls_for(requested, limits(), negotiated);
  EXPECT_EQ(controls[kGain], 10.6);
  EXPECT_EQ(controls[kFrameDuration], 16971.0);
  LibcameraNumbers metadata = controls;
  EXPECT_TRUE(are_in_effect(metadata, controls));
  metadata[kExposure] = 4970.0;  // whole rows
  EXPECT_TRUE(are_in_effect(metadata, controls));
  report_negotiated(requested, limits(), controls, metadata, negotiated);
  EXPECT_EQ(negotiated.str(),
            "rate_hz = 120: set to 58.92 (range 0.08498 to 58.92); gain = 2000: set to 1060 (range 100 to 1060)");
  metadata[kExposure] = 4000.0;
  EXPECT_FALSE(are_in_effect(metadata, controls));
  negotiated.clear();
  report_negotiated(requested, limits(), controls, metadata, negotiated);
  EXPECT_NE(negotiated.str().find("exposure_us = 5000: set to 4000 (range 75 to 1.17668e+07)"), std::string::npos)
      << negotiated.str();
}

TEST(LibcameraControls, ControlsThatTheCameraDoesNotReportAreNamed) {
  ErrorText negotiated;
  CameraSettings requested = settings();
  requested.white_balance_k = 0;
  const LibcameraNumbers controls = controls_for(requested, limits(), negotiated);
  EXPECT_TRUE(are_in_effect({}, controls));
  report_negotiated(requested, limits(), controls, {}, negotiated);
  EXPECT_EQ(
      negotiated.str(),
      "rate_hz = 30: set, but the camera does not report it; exposure_us = 5000: set, but the camera does not report "
      "it; gain = 250: set, but the camera does not report it; focus = 50: set, but the camera does not report it");
}

}  // namespace
}  // namespace touchline::hal
