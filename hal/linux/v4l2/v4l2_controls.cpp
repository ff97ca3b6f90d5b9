#include "hal/linux/v4l2/v4l2_controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cmath>
#include <cstdint>

#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Unit of V4L2_CID_EXPOSURE_ABSOLUTE.
constexpr int kExposureStepUs = 100;

struct Control {
  std::uint32_t id = 0;
  std::int64_t low = 0, high = 0, step = 1;
  int default_value = 0;  // the driver's default
};

bool find(const V4l2Device& device, std::uint32_t id, Control& found) {
  v4l2_queryctrl query{};
  query.id = id;
  if (device.request(VIDIOC_QUERYCTRL, &query) != 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return false;
  found = {id, query.minimum, query.maximum, std::max(query.step, 1), query.default_value};
  return true;
}

/// Returns the nearest valid value of the control: some drivers round invalid values, others refuse them.
int nearest(const Control& control, std::int64_t value) {
  const std::int64_t inside = std::clamp(value, control.low, control.high);
  const std::int64_t steps = (inside - control.low + control.step / 2) / control.step;
  const std::int64_t most =
      (control.high - control.low) / control.step;  // the maximum need not be a multiple of the step
  return static_cast<int>(control.low + std::min(steps, most) * control.step);
}

int set(const V4l2Device& device, std::uint32_t id, int value) {
  v4l2_control control{id, value};
  return device.request(VIDIOC_S_CTRL, &control);
}

int get(const V4l2Device& device, std::uint32_t id, int& value) {
  v4l2_control control{id, 0};
  const int error = device.request(VIDIOC_G_CTRL, &control);
  value = control.value;
  return error;
}

/// A key of the board file and its value: "exposure_us = 5000".
struct Setting {
  const char* key;
  int value;
};

/// A camera, and the text to which differences from the settings are appended.
struct ControlledCamera {
  const V4l2Device& device;
  ErrorText& negotiated;
  bool streams = false;  // while streaming, each write may cost frames, so unchanged values are not written
};

void note(ErrorText& negotiated, const Setting& setting) {
  negotiated.append_format("%s%s = %d: ", negotiated.separator(), setting.key, setting.value);
}

/// Turns off an automatic control if the camera has it. `to`: its value for "off"; `alternative`: an equivalent value
/// for cameras that refuse `to`.
void switch_off(const ControlledCamera& camera, std::uint32_t id, int to, int alternative, const char* name,
                const Setting& setting) {
  Control control;
  if (!find(camera.device, id, control)) return;
  int value = to;
  const auto is_off = [&] { return get(camera.device, id, value) == 0 && (value == to || value == alternative); };
  if (camera.streams && is_off()) return;
  int error = set(camera.device, id, to);
  if (error == EINVAL && alternative != to) error = set(camera.device, id, alternative);
  if (error == 0 && is_off()) return;
  note(camera.negotiated, setting);
  camera.negotiated.append_format("%s stays on (%s)", name,
                                  error != 0 ? system_text(error) : "the driver did not change it");
}

void switch_off(const ControlledCamera& camera, std::uint32_t id, const char* name, const Setting& setting) {
  switch_off(camera, id, 0, 0, name, setting);
}

/// Sets `setting.value`, divided by `unit`, and reads it back; returns false if the camera has no such control.
bool set_value(const ControlledCamera& camera, std::uint32_t id, int unit, const Setting& setting) {
  Control control;
  if (!find(camera.device, id, control)) return false;
  const int error = set(camera.device, id, nearest(control, (setting.value + unit / 2) / unit));
  if (error != 0) {
    note(camera.negotiated, setting);
    camera.negotiated.append_format("refused (%s)", system_text(error));
    return true;
  }
  int actual = 0;
  const int read_error = get(camera.device, id, actual);
  if (read_error != 0) {
    note(camera.negotiated, setting);
    camera.negotiated.append_format("set, but cannot be read back (%s)", system_text(read_error));
  } else if (std::int64_t{actual} * unit != setting.value) {
    note(camera.negotiated, setting);
    camera.negotiated.append_format("set to %" PRId64 " (range %" PRId64 " to %" PRId64 ", step %" PRId64 ")",
                                    std::int64_t{actual} * unit, control.low * unit, control.high * unit,
                                    control.step * unit);
  }
  return true;
}

void report_missing(const ControlledCamera& camera, const Setting& setting) {
  note(camera.negotiated, setting);
  camera.negotiated.append_format("the camera has no such control");
}

/// Turns off the dynamic frame rate, by which UVC cameras lower the negotiated frame rate in the dark.
void fix_rate(const ControlledCamera& camera, double rate_hz) {
  switch_off(camera, V4L2_CID_EXPOSURE_AUTO_PRIORITY, "dynamic frame rate",
             {"rate_hz", static_cast<int>(std::lround(rate_hz))});
}

void fix_exposure(const ControlledCamera& camera, const CameraSettings& requested) {
  const bool in_steps = requested.exposure_steps != kExposureStepsUnset;
  const Setting setting =
      in_steps ? Setting{"exposure_steps", requested.exposure_steps} : Setting{"exposure_us", requested.exposure_us};
  const std::uint32_t id = in_steps ? V4L2_CID_EXPOSURE : V4L2_CID_EXPOSURE_ABSOLUTE;
  Control steps;
  if (!in_steps && !find(camera.device, id, steps) && find(camera.device, V4L2_CID_EXPOSURE, steps)) {
    note(camera.negotiated, setting);
    camera.negotiated.append_format("the camera has driver-specific exposure steps, %" PRId64 " to %" PRId64
                                    ", instead of microseconds: set exposure_steps",
                                    steps.low, steps.high);
    return;  // automatic exposure is better than an arbitrary fixed one
  }
  if (!find(camera.device, id, steps)) return report_missing(camera, setting);
  // With shutter priority the exposure time is fixed and the aperture is automatic.
  switch_off(camera, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY, "automatic exposure",
             setting);
  set_value(camera, id, in_steps ? 1 : kExposureStepUs, setting);
}

void fix_gain(const ControlledCamera& camera, int gain) {
  const Setting setting{"gain", gain};
  switch_off(camera, V4L2_CID_AUTOGAIN, "automatic gain", setting);
  if (!set_value(camera, V4L2_CID_GAIN, 1, setting) && !set_value(camera, V4L2_CID_ANALOGUE_GAIN, 1, setting)) {
    report_missing(camera, setting);
  }
}

/// For a camera without color temperature: sets the red and blue gains to the driver's defaults, so that the tint does
/// not depend on what automatic white balance left behind. Returns false if the camera has no such gains.
bool set_gains(const ControlledCamera& camera, const Setting& setting) {
  Control red, blue;
  if (!find(camera.device, V4L2_CID_RED_BALANCE, red) || !find(camera.device, V4L2_CID_BLUE_BALANCE, blue))
    return false;
  int red_now = red.default_value, blue_now = blue.default_value;
  int error = set(camera.device, red.id, red.default_value);
  if (error == 0) error = set(camera.device, blue.id, blue.default_value);
  if (error == 0) error = get(camera.device, red.id, red_now);
  if (error == 0) error = get(camera.device, blue.id, blue_now);
  note(camera.negotiated, setting);
  camera.negotiated.append_format("the camera has no color temperature, only gains: ");
  if (error != 0) camera.negotiated.append_format("refused (%s)", system_text(error));
  if (error == 0) camera.negotiated.append_format("red %d, blue %d", red_now, blue_now);
  return true;
}

void fix_white_balance(const ControlledCamera& camera, int white_balance_k) {
  const Setting setting{"white_balance_k", white_balance_k};
  switch_off(camera, V4L2_CID_AUTO_WHITE_BALANCE, "automatic white balance", setting);
  if (!set_value(camera, V4L2_CID_WHITE_BALANCE_TEMPERATURE, 1, setting) && !set_gains(camera, setting)) {
    report_missing(camera, setting);
  }
}

void fix_focus(const ControlledCamera& camera, int focus) {
  const Setting setting{"focus", focus};
  switch_off(camera, V4L2_CID_FOCUS_AUTO, "automatic focus", setting);
  if (!set_value(camera, V4L2_CID_FOCUS_ABSOLUTE, 1, setting)) report_missing(camera, setting);
}

void fix_power_line(const V4l2Device& device, PowerLine power_line, ErrorText& negotiated) {
  const int hz = power_line == PowerLine::k50Hz ? 50 : power_line == PowerLine::k60Hz ? 60 : 0;
  const int value = hz == 50   ? V4L2_CID_POWER_LINE_FREQUENCY_50HZ
                    : hz == 60 ? V4L2_CID_POWER_LINE_FREQUENCY_60HZ
                               : V4L2_CID_POWER_LINE_FREQUENCY_DISABLED;
  Control control;
  const bool has_control = find(device, V4L2_CID_POWER_LINE_FREQUENCY, control);
  if (!has_control && hz == 0) return;  // no filter is requested, and there is none
  int actual = value;
  const int error = has_control ? set(device, V4L2_CID_POWER_LINE_FREQUENCY, value) : EINVAL;
  if (error == 0 && get(device, V4L2_CID_POWER_LINE_FREQUENCY, actual) == 0 && actual == value) return;
  negotiated.append_format("%spower_line = %s: %s", negotiated.separator(),
                           hz == 50   ? "50hz"
                           : hz == 60 ? "60hz"
                                      : "off",
                           !has_control ? "the camera has no such control"
                           : error != 0 ? system_text(error)
                                        : "the driver kept another value");
}

/// Reports a mirrored picture: one flip mirrors it, whereas both rotate it by 180 degrees, which does no harm. A camera
/// keeps these controls over restarts, and no picture of an empty field shows them.
void report_mirror(const V4l2Device& device, ErrorText& negotiated) {
  int horizontal = 0, vertical = 0;
  if (get(device, V4L2_CID_HFLIP, horizontal) != 0) horizontal = 0;
  if (get(device, V4L2_CID_VFLIP, vertical) != 0) vertical = 0;
  if ((horizontal != 0) == (vertical != 0)) return;
  const char* const name = horizontal != 0 ? "horizontal_flip" : "vertical_flip";
  negotiated.append_format(
      "%sthe camera mirrors the picture (%s is on), unless that undoes a mirror: robots' headings and turns would be "
      "reflected. Turn it off with v4l2-ctl --set-ctrl=%s=0; writing below the camera must be readable",
      negotiated.separator(), name, name);
}

/// With shutter priority the exposure time is fixed and the aperture is automatic.
bool is_exposure_automatic(const V4l2Device& device) {
  int mode = V4L2_EXPOSURE_MANUAL;
  return get(device, V4L2_CID_EXPOSURE_AUTO, mode) == 0 && mode != V4L2_EXPOSURE_MANUAL &&
         mode != V4L2_EXPOSURE_SHUTTER_PRIORITY;
}

Duration current_exposure(const V4l2Device& device) {
  if (is_exposure_automatic(device)) return {};
  int steps = 0;
  if (get(device, V4L2_CID_EXPOSURE_ABSOLUTE, steps) != 0 || steps < 0) return {};
  return std::chrono::microseconds(std::int64_t{steps} * kExposureStepUs);
}

Duration apply(const ControlledCamera& camera, const CameraSettings& requested) {
  // The flicker filter comes first, because it limits the exposure times that some cameras accept.
  if (requested.power_line != PowerLine::kLeave) fix_power_line(camera.device, requested.power_line, camera.negotiated);
  if (requested.exposure_us > 0 || requested.exposure_steps != kExposureStepsUnset) fix_exposure(camera, requested);
  if (requested.gain > 0) fix_gain(camera, requested.gain);
  if (requested.white_balance_k > 0) fix_white_balance(camera, requested.white_balance_k);
  if (requested.focus != kFocusUnset) fix_focus(camera, requested.focus);
  return current_exposure(camera.device);
}

}  // namespace

Duration apply_controls(const V4l2Device& device, const CameraSettings& requested, ErrorText& negotiated) {
  const ControlledCamera camera{device, negotiated};
  fix_rate(camera, requested.rate_hz);
  report_mirror(device, negotiated);
  return apply(camera, requested);
}

Duration change_controls(const V4l2Device& device, const CameraSettings& before, const CameraSettings& requested,
                         ErrorText& negotiated) {
  CameraSettings changes = requested;
  const bool other_flicker = requested.power_line != before.power_line;
  if (!other_flicker) changes.power_line = PowerLine::kLeave;
  if (!other_flicker && requested.exposure_us == before.exposure_us &&
      requested.exposure_steps == before.exposure_steps) {
    changes.exposure_us = 0;
    changes.exposure_steps = kExposureStepsUnset;
  }
  if (requested.gain == before.gain) changes.gain = 0;
  if (requested.white_balance_k == before.white_balance_k) changes.white_balance_k = 0;
  if (requested.focus == before.focus) changes.focus = kFocusUnset;
  return apply({device, negotiated, true}, changes);
}

void describe_controls(const V4l2Device& device, ErrorText& text) {
  Control control;
  const Duration exposure = current_exposure(device);
  if (exposure > Duration::zero()) {
    text.append_format(", exposure %" PRId64 " us",
                       std::int64_t{std::chrono::duration_cast<std::chrono::microseconds>(exposure).count()});
  } else if (find(device, V4L2_CID_EXPOSURE_ABSOLUTE, control)) {
    text.append_format(", exposure automatic");
  } else if (int steps = 0; get(device, V4L2_CID_EXPOSURE, steps) == 0) {
    text.append_format(is_exposure_automatic(device) ? ", exposure automatic" : ", exposure %d steps", steps);
  }
  const auto describe = [&](const char* name, std::uint32_t automatic, std::uint32_t id, const char* unit) {
    int value = 0;
    if (get(device, automatic, value) == 0 && value != 0) {
      text.append_format(", %s automatic", name);
    } else if (get(device, id, value) == 0) {
      text.append_format(", %s %d%s", name, value, unit);
    }
  };
  const bool has_gain = find(device, V4L2_CID_GAIN, control);
  describe("gain", V4L2_CID_AUTOGAIN, has_gain ? V4L2_CID_GAIN : V4L2_CID_ANALOGUE_GAIN, "");
  describe("white balance", V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CID_WHITE_BALANCE_TEMPERATURE, " K");
  describe("focus", V4L2_CID_FOCUS_AUTO, V4L2_CID_FOCUS_ABSOLUTE, "");
  int line = 0;
  if (get(device, V4L2_CID_POWER_LINE_FREQUENCY, line) != 0) return;
  text.append_format(", power line %s", line == V4L2_CID_POWER_LINE_FREQUENCY_DISABLED ? "off"
                                        : line == V4L2_CID_POWER_LINE_FREQUENCY_50HZ   ? "50 Hz"
                                        : line == V4L2_CID_POWER_LINE_FREQUENCY_60HZ   ? "60 Hz"
                                                                                       : "automatic");
}

}  // namespace touchline::hal
