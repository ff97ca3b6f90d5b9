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

// V4L2_CID_EXPOSURE_ABSOLUTE counts in steps of 100 us.
constexpr int kExposureStepUs = 100;

struct Control {
  std::uint32_t id = 0;
  std::int64_t low = 0, high = 0, step = 1;
  int normal = 0;  // the driver's default
};

bool find(const V4l2Device& device, std::uint32_t id, Control& found) {
  v4l2_queryctrl query{};
  query.id = id;
  if (device.request(VIDIOC_QUERYCTRL, &query) != 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return false;
  found = {id, query.minimum, query.maximum, std::max(query.step, 1), query.default_value};
  return true;
}

/// The nearest valid value of the control: some drivers round, others refuse.
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
struct Wish {
  const char* key;
  int value;
};

/// A camera, and the text to which differences from the settings are appended.
struct Controlled {
  const V4l2Device& device;
  ErrorText& negotiated;
  bool streams = false;  // then each write may cost frames; values that do not change are not written
};

void note(ErrorText& negotiated, const Wish& wish) {
  negotiated.append_format("%s%s = %d: ", negotiated.separator(), wish.key, wish.value);
}

/// Turns off an automatic control that a camera may lack. `or_to`: an equally good value for cameras that refuse `to`.
void switch_off(const Controlled& camera, std::uint32_t id, int to, int or_to, const char* name, const Wish& wish) {
  Control control;
  if (!find(camera.device, id, control)) return;
  int value = to;
  const auto is_off = [&] { return get(camera.device, id, value) == 0 && (value == to || value == or_to); };
  if (camera.streams && is_off()) return;
  int error = set(camera.device, id, to);
  if (error == EINVAL && or_to != to) error = set(camera.device, id, or_to);
  if (error == 0 && is_off()) return;
  note(camera.negotiated, wish);
  camera.negotiated.append_format("%s stays on (%s)", name, error != 0 ? system_text(error) : "the driver kept it");
}

void switch_off(const Controlled& camera, std::uint32_t id, const char* name, const Wish& wish) {
  switch_off(camera, id, 0, 0, name, wish);
}

/// Sets `wish.value`, converted to steps of `unit`, and reads it back; false if the camera has no such control.
bool set_value(const Controlled& camera, std::uint32_t id, int unit, const Wish& wish) {
  Control control;
  if (!find(camera.device, id, control)) return false;
  const int error = set(camera.device, id, nearest(control, (wish.value + unit / 2) / unit));
  if (error != 0) {
    note(camera.negotiated, wish);
    camera.negotiated.append_format("refused (%s)", system_text(error));
    return true;
  }
  int granted = 0;
  const int read_error = get(camera.device, id, granted);
  if (read_error != 0) {
    note(camera.negotiated, wish);
    camera.negotiated.append_format("set, but cannot be read back (%s)", system_text(read_error));
  } else if (std::int64_t{granted} * unit != wish.value) {
    note(camera.negotiated, wish);
    camera.negotiated.append_format("set to %" PRId64 " (range %" PRId64 " to %" PRId64 ", step %" PRId64 ")",
                                    std::int64_t{granted} * unit, control.low * unit, control.high * unit,
                                    control.step * unit);
  }
  return true;
}

void lacking(const Controlled& camera, const Wish& wish) {
  note(camera.negotiated, wish);
  camera.negotiated.append_format("the camera has no such control");
}

/// Otherwise UVC cameras lower the frame rate in the dark, whatever rate was negotiated.
void fix_rate(const Controlled& camera, double rate_hz) {
  switch_off(camera, V4L2_CID_EXPOSURE_AUTO_PRIORITY, "exposure before frame rate",
             {"rate_hz", static_cast<int>(std::lround(rate_hz))});
}

void fix_exposure(const Controlled& camera, const CameraSettings& asked) {
  const bool in_steps = asked.exposure_steps != kExposureStepsLeave;
  const Wish wish = in_steps ? Wish{"exposure_steps", asked.exposure_steps} : Wish{"exposure_us", asked.exposure_us};
  const std::uint32_t id = in_steps ? V4L2_CID_EXPOSURE : V4L2_CID_EXPOSURE_ABSOLUTE;
  Control steps;
  if (!in_steps && !find(camera.device, id, steps) && find(camera.device, V4L2_CID_EXPOSURE, steps)) {
    note(camera.negotiated, wish);
    camera.negotiated.append_format("the camera counts exposure in steps of its own, %" PRId64 " to %" PRId64
                                    ", and not in time: exposure_steps fixes it",
                                    steps.low, steps.high);
    return;  // an arbitrary fixed exposure would be worse than an automatic one
  }
  if (!find(camera.device, id, steps)) return lacking(camera, wish);
  // With shutter priority the exposure time is fixed and the aperture is automatic.
  switch_off(camera, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY, "automatic exposure",
             wish);
  set_value(camera, id, in_steps ? 1 : kExposureStepUs, wish);
}

void fix_gain(const Controlled& camera, int gain) {
  const Wish wish{"gain", gain};
  switch_off(camera, V4L2_CID_AUTOGAIN, "automatic gain", wish);
  if (!set_value(camera, V4L2_CID_GAIN, 1, wish) && !set_value(camera, V4L2_CID_ANALOGUE_GAIN, 1, wish)) {
    lacking(camera, wish);
  }
}

/// Sets the gains of red and blue of a camera without a color temperature: to the defaults of the driver and not to
/// what automatic white balance left behind, so that the tint is the same at each start. False: the camera has no such
/// gains.
bool set_gains(const Controlled& camera, const Wish& wish) {
  Control red, blue;
  if (!find(camera.device, V4L2_CID_RED_BALANCE, red) || !find(camera.device, V4L2_CID_BLUE_BALANCE, blue))
    return false;
  int red_now = red.normal, blue_now = blue.normal;
  int error = set(camera.device, red.id, red.normal);
  if (error == 0) error = set(camera.device, blue.id, blue.normal);
  if (error == 0) error = get(camera.device, red.id, red_now);
  if (error == 0) error = get(camera.device, blue.id, blue_now);
  note(camera.negotiated, wish);
  camera.negotiated.append_format("the camera takes gains only: ");
  if (error != 0) camera.negotiated.append_format("refused (%s)", system_text(error));
  if (error == 0) camera.negotiated.append_format("red %d, blue %d", red_now, blue_now);
  return true;
}

void fix_white_balance(const Controlled& camera, int white_balance_k) {
  const Wish wish{"white_balance_k", white_balance_k};
  switch_off(camera, V4L2_CID_AUTO_WHITE_BALANCE, "automatic white balance", wish);
  if (!set_value(camera, V4L2_CID_WHITE_BALANCE_TEMPERATURE, 1, wish) && !set_gains(camera, wish)) {
    lacking(camera, wish);
  }
}

void fix_focus(const Controlled& camera, int focus) {
  const Wish wish{"focus", focus};
  switch_off(camera, V4L2_CID_FOCUS_AUTO, "automatic focus", wish);
  if (!set_value(camera, V4L2_CID_FOCUS_ABSOLUTE, 1, wish)) lacking(camera, wish);
}

void fix_power_line(const V4l2Device& device, PowerLine power_line, ErrorText& negotiated) {
  const int hz = power_line == PowerLine::k50Hz ? 50 : power_line == PowerLine::k60Hz ? 60 : 0;
  const int value = hz == 50   ? V4L2_CID_POWER_LINE_FREQUENCY_50HZ
                    : hz == 60 ? V4L2_CID_POWER_LINE_FREQUENCY_60HZ
                               : V4L2_CID_POWER_LINE_FREQUENCY_DISABLED;
  Control control;
  const bool there = find(device, V4L2_CID_POWER_LINE_FREQUENCY, control);
  if (!there && hz == 0) return;  // without the control there is no filter, as asked
  int granted = value;
  const int error = there ? set(device, V4L2_CID_POWER_LINE_FREQUENCY, value) : EINVAL;
  if (error == 0 && get(device, V4L2_CID_POWER_LINE_FREQUENCY, granted) == 0 && granted == value) return;
  negotiated.append_format("%spower_line = %s: %s", negotiated.separator(),
                           hz == 50   ? "50hz"
                           : hz == 60 ? "60hz"
                                      : "off",
                           !there       ? "the camera has no such control"
                           : error != 0 ? system_text(error)
                                        : "the driver kept another");
}

/// With shutter priority the exposure time is fixed and the aperture is automatic.
bool is_exposure_automatic(const V4l2Device& device) {
  int mode = V4L2_EXPOSURE_MANUAL;
  return get(device, V4L2_CID_EXPOSURE_AUTO, mode) == 0 && mode != V4L2_EXPOSURE_MANUAL &&
         mode != V4L2_EXPOSURE_SHUTTER_PRIORITY;
}

Duration exposure_in_force(const V4l2Device& device) {
  if (is_exposure_automatic(device)) return {};
  int steps = 0;
  if (get(device, V4L2_CID_EXPOSURE_ABSOLUTE, steps) != 0 || steps < 0) return {};
  return std::chrono::microseconds(std::int64_t{steps} * kExposureStepUs);
}

Duration apply(const Controlled& camera, const CameraSettings& asked) {
  // First the flicker filter: it limits the exposures that some cameras accept.
  if (asked.power_line != PowerLine::kLeave) fix_power_line(camera.device, asked.power_line, camera.negotiated);
  if (asked.exposure_us > 0 || asked.exposure_steps != kExposureStepsLeave) fix_exposure(camera, asked);
  if (asked.gain > 0) fix_gain(camera, asked.gain);
  if (asked.white_balance_k > 0) fix_white_balance(camera, asked.white_balance_k);
  if (asked.focus != kFocusLeave) fix_focus(camera, asked.focus);
  return exposure_in_force(camera.device);
}

}  // namespace

Duration apply_controls(const V4l2Device& device, const CameraSettings& asked, ErrorText& negotiated) {
  const Controlled camera{device, negotiated};
  fix_rate(camera, asked.rate_hz);
  return apply(camera, asked);
}

Duration change_controls(const V4l2Device& device, const CameraSettings& before, const CameraSettings& asked,
                         ErrorText& negotiated) {
  CameraSettings changes = asked;
  const bool other_flicker = asked.power_line != before.power_line;
  if (!other_flicker) changes.power_line = PowerLine::kLeave;
  if (!other_flicker && asked.exposure_us == before.exposure_us && asked.exposure_steps == before.exposure_steps) {
    changes.exposure_us = 0;
    changes.exposure_steps = kExposureStepsLeave;
  }
  if (asked.gain == before.gain) changes.gain = 0;
  if (asked.white_balance_k == before.white_balance_k) changes.white_balance_k = 0;
  if (asked.focus == before.focus) changes.focus = kFocusLeave;
  return apply({device, negotiated, true}, changes);
}

void describe_controls(const V4l2Device& device, ErrorText& text) {
  Control control;
  const Duration exposure = exposure_in_force(device);
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
