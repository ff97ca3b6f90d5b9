#include "hal/linux/libcamera/libcamera_controls.h"

#include <algorithm>
#include <cmath>

namespace touchline::hal {
namespace {

using enum LibcameraControl;

// Relative difference that rounding causes: exposure is rounded to rows, gain to steps.
constexpr double kTolerance = 0.01;

bool is_near(double a, double b) { return std::abs(a - b) <= kTolerance * std::max(std::abs(a), std::abs(b)); }

// Lamps flicker at twice the mains frequency.
double flicker_period_us(PowerLine power_line) { return power_line == PowerLine::k50Hz ? 1e6 / 100.0 : 1e6 / 120.0; }

const char* word_of(PowerLine power_line) {
  for (const Choice<PowerLine>& choice : kPowerLines) {
    if (choice.value == power_line) return choice.word.data();
  }
  return "";
}

/// A key of the board file and its controls.
struct Key {
  const char* name;
  double requested = 0.0;  // in units of the key
  double unit = 1.0;       // libcamera's value for one unit of the key
  LibcameraControl value, manual;
};

constexpr std::size_t kKeys = 4;
std::array<Key, kKeys> keys_of(const CameraSettings& requested) {
  return {{{"exposure_us", static_cast<double>(requested.exposure_us), 1.0, kExposure, kExposureManual},
           {"gain", static_cast<double>(requested.gain), 1.0 / kLibcameraSteps, kGain, kGainManual},
           {"white_balance_k", static_cast<double>(requested.white_balance_k), 1.0, kTemperature, kWhiteBalanceManual},
           {"focus", static_cast<double>(requested.focus), 1.0 / kLibcameraSteps, kLensPosition, kFocusManual}}};
}

bool is_requested(const Key& key) { return key.value == kLensPosition ? key.requested >= 0.0 : key.requested > 0.0; }

void append_key(ErrorText& negotiated, const char* key, double requested) {
  negotiated.append_format("%s%s = %.6g: ", negotiated.separator(), key, requested);
}

void append_power_line(ErrorText& negotiated, PowerLine power_line) {
  negotiated.append_format("%spower_line = %s: ", negotiated.separator(), word_of(power_line));
}

constexpr const char* kNotReported = "set, but the camera does not report it";

void append_missing(ErrorText& negotiated) { negotiated.append_format("the camera has no such control"); }

double within(const LibcameraLimits& limits, LibcameraControl control, double value) {
  return std::min(std::max(value, *limits.low[control]), *limits.high[control]);
}

// For cameras without color temperature: gains of a common sensor (within 10 % of those of the IMX219 between 2500 and
// 5700 K). Other sensors get a constant tint, which color calibration compensates.
void set_gains(const LibcameraLimits& limits, double temperature_k, LibcameraNumbers& controls) {
  const double relative = temperature_k / 5600.0;
  controls[kWhiteBalanceManual] = 1.0;
  controls[kRedGain] = within(limits, kRedGain, 2.2 * std::pow(relative, 0.9));
  controls[kBlueGain] = within(limits, kBlueGain, 1.86 * std::pow(relative, -0.5));
}

/// Returns the value of a control that the frame reports; otherwise the value that was set.
double actual_value(const LibcameraNumbers& controls, const LibcameraNumbers& reported, LibcameraControl control) {
  return reported[control].value_or(*controls[control]);
}

void report_difference(const Key& key, const LibcameraLimits& limits, const LibcameraNumbers& controls,
                       const LibcameraNumbers& reported, ErrorText& negotiated) {
  if (!controls[key.value]) return;
  const double got = actual_value(controls, reported, key.value);
  if (!is_near(got, key.requested * key.unit)) {
    append_key(negotiated, key.name, key.requested);
    negotiated.append_format("set to %.6g (range %.6g to %.6g)", got / key.unit, *limits.low[key.value] / key.unit,
                             *limits.high[key.value] / key.unit);
  } else if (!reported[key.value]) {
    append_key(negotiated, key.name, key.requested);
    negotiated.append_format("%s", kNotReported);
  }
}

}  // namespace

LibcameraNumbers controls_for(const CameraSettings& requested, const LibcameraLimits& limits, ErrorText& negotiated) {
  LibcameraNumbers controls;
  for (const Key& key : keys_of(requested)) {
    if (!is_requested(key)) continue;
    if (limits.has(key.value)) {
      controls[key.manual] = 1.0;
      controls[key.value] = within(limits, key.value, key.requested * key.unit);
    } else if (key.value == kTemperature && limits.has(kRedGain)) {
      set_gains(limits, key.requested, controls);
    } else {
      append_key(negotiated, key.name, key.requested);
      append_missing(negotiated);
    }
  }
  if (requested.exposure_steps != kExposureStepsUnset) {
    append_key(negotiated, "exposure_steps", requested.exposure_steps);
    append_missing(negotiated);
  }
  if (limits.has(kFlickerPeriod)) {
    if (requested.power_line == PowerLine::kOff) controls[kFlickerManual] = 0.0;
    if (requested.power_line == PowerLine::k50Hz || requested.power_line == PowerLine::k60Hz) {
      controls[kFlickerManual] = 1.0;
      controls[kFlickerPeriod] = within(limits, kFlickerPeriod, flicker_period_us(requested.power_line));
    }
  } else if (requested.power_line == PowerLine::k50Hz || requested.power_line == PowerLine::k60Hz) {
    append_power_line(negotiated, requested.power_line);
    append_missing(negotiated);
  }
  if (requested.rate_hz > 0.0 && limits.has(kFrameDuration)) {
    controls[kFrameDuration] = within(limits, kFrameDuration, 1e6 / requested.rate_hz);
  }
  return controls;
}

void describe_controls(const LibcameraNumbers& reported, ErrorText& text) {
  if (reported[kExposure]) text.append_format(", exposure %.0f us", *reported[kExposure]);
  if (reported[kGain]) text.append_format(", gain %.0f", *reported[kGain] * kLibcameraSteps);
  if (reported[kTemperature]) text.append_format(", white balance %.0f K", *reported[kTemperature]);
  if (reported[kRedGain] && reported[kBlueGain])
    text.append_format(", red x%.3g, blue x%.3g", *reported[kRedGain], *reported[kBlueGain]);
  if (reported[kLensPosition]) text.append_format(", focus %.0f", *reported[kLensPosition] * kLibcameraSteps);
}

bool are_in_effect(const LibcameraNumbers& reported, const LibcameraNumbers& controls) {
  for (const LibcameraControl control : {kExposure, kGain, kRedGain, kBlueGain, kFrameDuration, kLensPosition}) {
    if (controls[control] && reported[control] && !is_near(*controls[control], *reported[control])) return false;
  }
  return true;
}

LibcameraNumbers adjusted(const LibcameraNumbers& before, const LibcameraNumbers& controls) {
  LibcameraNumbers all = before;
  for (std::size_t i = 0; i < kLibcameraControls; ++i) {
    const auto control = static_cast<LibcameraControl>(i);
    if (controls[control]) all[control] = controls[control];
  }
  return all;
}

void report_negotiated_controls(const CameraSettings& requested, const LibcameraLimits& limits,
                                const LibcameraNumbers& controls, const LibcameraNumbers& reported,
                                ErrorText& negotiated) {
  for (const Key& key : keys_of(requested)) {
    if (is_requested(key)) report_difference(key, limits, controls, reported, negotiated);
  }
  if (requested.white_balance_k > 0 && controls[kRedGain]) {
    append_key(negotiated, "white_balance_k", requested.white_balance_k);
    negotiated.append_format("the camera has no color temperature, only gains: red %.3g, blue %.3g",
                             actual_value(controls, reported, kRedGain), actual_value(controls, reported, kBlueGain));
  }
}

void report_negotiated(const CameraSettings& requested, const LibcameraLimits& limits, const LibcameraNumbers& controls,
                       const LibcameraNumbers& reported, ErrorText& negotiated) {
  if (!controls[kFrameDuration]) {
    append_key(negotiated, "rate_hz", requested.rate_hz);
    negotiated.append_format("the camera does not report its frame rate");
  } else if (const double rate_hz = 1e6 / actual_value(controls, reported, kFrameDuration);
             !is_near(rate_hz, requested.rate_hz)) {
    append_key(negotiated, "rate_hz", requested.rate_hz);
    negotiated.append_format("set to %.4g (range %.4g to %.4g)", rate_hz, 1e6 / *limits.high[kFrameDuration],
                             1e6 / *limits.low[kFrameDuration]);
  } else if (!reported[kFrameDuration]) {
    append_key(negotiated, "rate_hz", requested.rate_hz);
    negotiated.append_format("%s", kNotReported);
  }
  report_negotiated_controls(requested, limits, controls, reported, negotiated);
}

}  // namespace touchline::hal
