#include "hal/linux/libcamera/libcamera_numbers.h"

#include <cmath>

#include "hal/linux/libcamera/libcamera_version.h"

namespace touchline::hal {
namespace {

using enum LibcameraControl;
namespace controls = libcamera::controls;

/// Returns the value, or the first element of an array; nothing if it is not a number.
std::optional<double> number_of(const libcamera::ControlValue& value) {
  if (value.numElements() == 0) return std::nullopt;
  const auto first = [&]<class T>(T) {
    return static_cast<double>(value.isArray() ? value.get<libcamera::Span<const T>>()[0] : value.get<T>());
  };
  switch (value.type()) {
    case libcamera::ControlTypeInteger32:
      return first(std::int32_t{});
    case libcamera::ControlTypeInteger64:
      return first(std::int64_t{});
    case libcamera::ControlTypeFloat:
      return first(float{});
    default:
      return std::nullopt;
  }
}

void add(LibcameraLimits& limits, LibcameraControl ours, const libcamera::ControlInfoMap& of_camera,
         const libcamera::ControlId& control) {
  const auto found = of_camera.find(&control);
  if (found == of_camera.end()) return;
  const std::optional<double> low = number_of(found->second.min()), high = number_of(found->second.max());
  if (!low || !high) return;
  limits.low[ours] = *low;
  limits.high[ours] = *high;
}

template <class T>
void set_rounded(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera,
                 const libcamera::Control<T>& control, const std::optional<double>& number) {
  if (number) version::set(list, of_camera, control, static_cast<T>(std::lround(*number)));
}

}  // namespace

LibcameraLimits limits_of(const libcamera::ControlInfoMap& of_camera) {
  LibcameraLimits limits;
  add(limits, kExposure, of_camera, controls::ExposureTime);
  add(limits, kGain, of_camera, controls::AnalogueGain);
  add(limits, kTemperature, of_camera, controls::ColourTemperature);
  add(limits, kRedGain, of_camera, controls::ColourGains);
  add(limits, kBlueGain, of_camera, controls::ColourGains);
  if (version::flicker_period() != nullptr) add(limits, kFlickerPeriod, of_camera, *version::flicker_period());
  add(limits, kFrameDuration, of_camera, controls::FrameDurationLimits);
  add(limits, kLensPosition, of_camera, controls::LensPosition);
  return limits;
}

void set_controls(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera,
                  const LibcameraNumbers& numbers, bool external) {
  version::set_exposure_modes(list, of_camera, numbers[kExposureManual].has_value(), numbers[kGainManual].has_value(),
                              external);
  set_rounded(list, of_camera, controls::ExposureTime, numbers[kExposure]);
  if (numbers[kGain]) version::set(list, of_camera, controls::AnalogueGain, static_cast<float>(*numbers[kGain]));
  if (numbers[kWhiteBalanceManual]) version::set(list, of_camera, controls::AwbEnable, false);
  set_rounded(list, of_camera, controls::ColourTemperature, numbers[kTemperature]);
  if (numbers[kRedGain] && numbers[kBlueGain]) {
    const std::array<float, 2> gains{static_cast<float>(*numbers[kRedGain]), static_cast<float>(*numbers[kBlueGain])};
    version::set(list, of_camera, controls::ColourGains, libcamera::Span<const float, 2>(gains));
  }
  if (numbers[kFlickerManual]) version::set_flicker_mode(list, of_camera, *numbers[kFlickerManual] != 0.0);
  if (version::flicker_period() != nullptr) {
    set_rounded(list, of_camera, *version::flicker_period(), numbers[kFlickerPeriod]);
  }
  if (numbers[kFrameDuration]) {
    const auto duration_us = static_cast<std::int64_t>(std::llround(*numbers[kFrameDuration]));
    const std::array<std::int64_t, 2> both{duration_us, duration_us};
    version::set(list, of_camera, controls::FrameDurationLimits, libcamera::Span<const std::int64_t, 2>(both));
  }
  if (numbers[kFocusManual]) version::set(list, of_camera, controls::AfMode, controls::AfModeManual);
  if (numbers[kLensPosition]) {
    version::set(list, of_camera, controls::LensPosition, static_cast<float>(*numbers[kLensPosition]));
  }
}

LibcameraNumbers reported_by(const libcamera::ControlList& metadata) {
  LibcameraNumbers reported;
  const auto note = [&](LibcameraControl ours, const auto& value) {
    if (value) reported[ours] = static_cast<double>(*value);
  };
  note(kExposure, metadata.get(controls::ExposureTime));
  note(kGain, metadata.get(controls::AnalogueGain));
  note(kTemperature, metadata.get(controls::ColourTemperature));
  note(kFrameDuration, metadata.get(controls::FrameDuration));
  note(kLensPosition, metadata.get(controls::LensPosition));
  if (const auto gains = metadata.get(controls::ColourGains)) {
    reported[kRedGain] = (*gains)[0];
    reported[kBlueGain] = (*gains)[1];
  }
  return reported;
}

}  // namespace touchline::hal
