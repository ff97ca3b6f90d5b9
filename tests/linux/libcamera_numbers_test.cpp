// Uses libcamera's own types, so this file is compiled only if libcamera is installed.
#include "hal/linux/libcamera/libcamera_numbers.h"

#include <gtest/gtest.h>
#include <libcamera/control_ids.h>

#include <cerrno>
#include <vector>

#include "hal/linux/libcamera/libcamera_camera.h"

namespace touchline::hal {
namespace {

using enum LibcameraControl;
namespace controls = libcamera::controls;
using libcamera::ControlInfo;

/// A Raspberry Pi's camera as libcamera 0.0.3 describes it.
const libcamera::ControlInfoMap& camera() {
  static const libcamera::ControlInfoMap map(
      {{&controls::AeEnable, ControlInfo(false, true)},
       {&controls::ExposureTime, ControlInfo(75, 11766829)},
       {&controls::AnalogueGain, ControlInfo(1.0f, 10.5f)},
       {&controls::AwbEnable, ControlInfo(false, true)},
       {&controls::ColourGains, ControlInfo(0.0f, 32.0f)},
       {&controls::FrameDurationLimits, ControlInfo(std::int64_t{16971}, std::int64_t{11767556})},
       {&controls::AfMode, ControlInfo(0, 2)},
       {&controls::LensPosition, ControlInfo(0.0f, 32.0f)}},
      controls::controls);
  return map;
}

TEST(LibcameraNumbers, LimitsAreThoseOfTheCamera) {
  const LibcameraLimits limits = limits_of(camera());
  EXPECT_EQ(limits.low[kExposure], 75.0);
  EXPECT_EQ(limits.high[kExposure], 11766829.0);
  EXPECT_EQ(limits.high[kGain], 10.5);
  EXPECT_EQ(limits.high[kRedGain], 32.0);
  EXPECT_EQ(limits.low[kFrameDuration], 16971.0);
  EXPECT_EQ(limits.high[kLensPosition], 32.0);
  EXPECT_FALSE(limits.has(kTemperature));
  EXPECT_FALSE(limits.has(kFlickerPeriod));
}

TEST(LibcameraNumbers, NumbersBecomeControlsThatTheCameraHas) {
  LibcameraNumbers numbers;
  numbers[kExposureManual] = numbers[kGainManual] = numbers[kWhiteBalanceManual] = numbers[kFocusManual] = 1.0;
  numbers[kExposure] = 5000.4;
  numbers[kGain] = 2.5;
  numbers[kTemperature] = 4600.0;  // which this camera lacks
  numbers[kRedGain] = 1.5;
  numbers[kBlueGain] = 2.0;
  numbers[kFrameDuration] = 33333.3;
  numbers[kLensPosition] = 0.5;
  libcamera::ControlList list(controls::controls);
  set_controls(list, camera(), numbers, false);
  EXPECT_EQ(list.get(controls::AeEnable), false);
  EXPECT_EQ(list.get(controls::ExposureTime), 5000);
  EXPECT_EQ(list.get(controls::AnalogueGain), 2.5f);
  EXPECT_EQ(list.get(controls::AwbEnable), false);
  EXPECT_FALSE(list.contains(controls::ColourTemperature.id()));
  ASSERT_TRUE(list.contains(controls::ColourGains.id()));
  EXPECT_EQ((*list.get(controls::ColourGains))[0], 1.5f);
  EXPECT_EQ((*list.get(controls::ColourGains))[1], 2.0f);
  ASSERT_TRUE(list.contains(controls::FrameDurationLimits.id()));
  EXPECT_EQ((*list.get(controls::FrameDurationLimits))[0], 33333);
  EXPECT_EQ((*list.get(controls::FrameDurationLimits))[1], 33333);
  EXPECT_EQ(list.get(controls::AfMode), controls::AfModeManual);
  EXPECT_EQ(list.get(controls::LensPosition), 0.5f);
}

TEST(LibcameraNumbers, AUsbCameraFixesExposureAndGainTogether) {
  LibcameraNumbers exposure_alone;
  exposure_alone[kExposureManual] = 1.0;
  libcamera::ControlList inside(controls::controls), at_usb(controls::controls);
  set_controls(inside, camera(), exposure_alone, false);
  set_controls(at_usb, camera(), exposure_alone, true);
  EXPECT_EQ(inside.get(controls::AeEnable), true);  // the camera still controls the gain
  EXPECT_EQ(at_usb.get(controls::AeEnable), false);
}

TEST(LibcameraNumbers, MetadataIsRead) {
  libcamera::ControlList metadata(controls::controls);
  EXPECT_FALSE(reported_by(metadata)[kExposure]);
  metadata.set(controls::ExposureTime, 4970);
  metadata.set(controls::AnalogueGain, 1.5f);
  metadata.set(controls::FrameDuration, std::int64_t{33320});
  const std::vector<float> gains{1.25f, 2.5f};
  metadata.set(controls::ColourGains, libcamera::Span<const float, 2>(gains.data(), 2));
  const LibcameraNumbers numbers = reported_by(metadata);
  EXPECT_EQ(numbers[kExposure], 4970.0);
  EXPECT_EQ(numbers[kGain], 1.5);
  EXPECT_EQ(numbers[kFrameDuration], 33320.0);
  EXPECT_EQ(numbers[kRedGain], 1.25);
  EXPECT_EQ(numbers[kBlueGain], 2.5);
}

// Runs on any machine, with or without cameras.
TEST(LibcameraLink, TheLibraryCanBeStartedRepeatedly) {
  CameraSettings settings;
  settings.device = "no such camera";
  LibcameraCamera camera(settings, 0, make_libcamera_link());
  for (int i = 0; i < 3; ++i) {
    const Result<void> opened = camera.open();
    EXPECT_EQ(opened.code(), ErrorCode::kNotFound);
    EXPECT_EQ(opened.text().find("no such camera: no such camera; available cameras: "), 0u) << opened.text();
    EXPECT_NE(opened.text().find(list_of(libcamera_cameras())), std::string::npos);
  }
}

}  // namespace
}  // namespace touchline::hal
