#include "hal/linux/libcamera/libcamera_controls.h"

#include <gtest/gtest.h>

namespace touchline::hal {
namespace {

using enum LibcameraControl;

/// What a Raspberry Pi's camera can be told.
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

  CameraSettings asked = settings();
  asked.power_line = PowerLine::k60Hz;
  EXPECT_DOUBLE_EQ(*controls_for(asked, camera, negotiated)[kFlickerPeriod], 1e6 / 120.0);
  asked.power_line = PowerLine::kOff;
  EXPECT_EQ(controls_for(asked, camera, negotiated)[kFlickerManual], 0.0);
}

TEST(LibcameraControls, WhatIsLeftToTheCameraIsNotTouched) {
  CameraSettings asked;  // focus is left by default
  asked.exposure_us = asked.gain = asked.white_balance_k = 0;
  asked.rate_hz = 0.0;
  ErrorText negotiated;
  const LibcameraNumbers controls = controls_for(asked, limits(), negotiated);
  for (std::size_t i = 0; i < kLibcameraControls; ++i) EXPECT_FALSE(controls[static_cast<LibcameraControl>(i)]) << i;
  EXPECT_EQ(negotiated.str(), "");
}

TEST(LibcameraControls, ACameraWithoutTemperatureGetsTheGainsOfACommonSensor) {
  ErrorText negotiated;
  CameraSettings asked = settings();
  asked.white_balance_k = 5600;
  LibcameraNumbers controls = controls_for(asked, limits(), negotiated);
  EXPECT_EQ(controls[kWhiteBalanceManual], 1.0);
  EXPECT_NEAR(*controls[kRedGain], 2.2, 1e-9);
  EXPECT_NEAR(*controls[kBlueGain], 1.86, 1e-9);
  asked.white_balance_k = 2500;  // warm light needs less red
  controls = controls_for(asked, limits(), negotiated);
  EXPECT_NEAR(*controls[kRedGain], 1.07, 0.02);
  EXPECT_NEAR(*controls[kBlueGain], 2.78, 0.02);
  report_negotiated(asked, limits(), controls, controls, negotiated);
  EXPECT_EQ(negotiated.str(), "white_balance_k = 2500: the camera takes gains only: red 1.06, blue 2.78");
}

TEST(LibcameraControls, WhatACameraLacksIsTold) {
  ErrorText negotiated;
  const LibcameraNumbers controls = controls_for(settings(), {}, negotiated);
  report_negotiated(settings(), {}, controls, {}, negotiated);
  EXPECT_EQ(negotiated.str(),
            "exposure_us = 5000: the camera has no such control; gain = 250: the camera has no such control; "
            "white_balance_k = 4600: the camera has no such control; focus = 50: the camera has no such control; "
            "power_line = 50hz: the camera has no such control; "
            "rate_hz = 30: the camera does not tell its rate");
  negotiated.clear();
  CameraSettings asked = settings();
  asked.power_line = PowerLine::kOff;  // it filters nothing, as asked
  asked.exposure_us = asked.gain = asked.white_balance_k = 0;
  asked.focus = kFocusLeave;
  EXPECT_FALSE(controls_for(asked, {}, negotiated)[kFlickerManual]);
  EXPECT_EQ(negotiated.str(), "");
  asked.exposure_steps = 40;
  static_cast<void>(controls_for(asked, {}, negotiated));
  EXPECT_EQ(negotiated.str(), "exposure_steps = 40: the camera has no such control");
}

TEST(LibcameraControls, WhatIsGrantedOtherwiseIsToldInTheKeysUnits) {
  CameraSettings asked = settings();
  asked.gain = 2000;
  asked.rate_hz = 120.0;
  asked.white_balance_k = 0;
  ErrorText negotiated;
  const LibcameraNumbers controls = controls_for(asked, limits(), negotiated);
  EXPECT_EQ(controls[kGain], 10.6);
  EXPECT_EQ(controls[kFrameDuration], 16971.0);
  LibcameraNumbers told = controls;
  EXPECT_TRUE(is_taken_with(told, controls));
  told[kExposure] = 4970.0;  // whole rows
  EXPECT_TRUE(is_taken_with(told, controls));
  report_negotiated(asked, limits(), controls, told, negotiated);
  EXPECT_EQ(negotiated.str(),
            "rate_hz = 120: set to 58.92 (range 0.08498 to 58.92); gain = 2000: set to 1060 (range 100 to 1060)");
  told[kExposure] = 4000.0;
  EXPECT_FALSE(is_taken_with(told, controls));
  negotiated.clear();
  report_negotiated(asked, limits(), controls, told, negotiated);
  EXPECT_NE(negotiated.str().find("exposure_us = 5000: set to 4000 (range 75 to 1.17668e+07)"), std::string::npos)
      << negotiated.str();
}

TEST(LibcameraControls, WhatIsNotToldBackIsToldToThePerson) {
  ErrorText negotiated;
  CameraSettings asked = settings();
  asked.white_balance_k = 0;
  const LibcameraNumbers controls = controls_for(asked, limits(), negotiated);
  EXPECT_TRUE(is_taken_with({}, controls));
  report_negotiated(asked, limits(), controls, {}, negotiated);
  EXPECT_EQ(negotiated.str(),
            "rate_hz = 30: set, but the camera does not tell it back; exposure_us = 5000: set, but the camera does not "
            "tell it back; gain = 250: set, but the camera does not tell it back; focus = 50: set, but the camera does "
            "not tell it back");
}

}  // namespace
}  // namespace touchline::hal
