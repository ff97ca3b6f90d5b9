#include "hal/linux/gpiod_gpio.h"

#include "hal/linux/system_error.h"

namespace touchline::hal {

Status GpiodGpio::do_open() {
  do_close();
  reason_.clear();
  Status status;
  if (settings_.emergency_stop_line != kNoLine && settings_.emergency_stop_line == settings_.status_led_line) {
    reason_.set("%s line %d: is both the status light and the emergency stop", settings_.chip.c_str(),
                settings_.status_led_line);
    return ErrorCode::kInconsistent;
  }
  if (settings_.emergency_stop_line != kNoLine) {
    status = emergency_stop_.request_input(settings_.chip, settings_.emergency_stop_line,
                                           settings_.emergency_stop_active_low, settings_.emergency_stop_bias, reason_);
  }
  if (status.ok() && settings_.status_led_line != kNoLine) {
    status = status_led_.request_output(settings_.chip, settings_.status_led_line, reason_);
  }
  if (!status.ok()) do_close();
  open_ = status.ok();
  return status;
}

void GpiodGpio::do_close() {
  // A light that stays on would say that the program still runs.
  if (status_led_.requested()) static_cast<void>(status_led_.set(false));
  status_led_.release();
  emergency_stop_.release();
  open_ = false;
}

Status GpiodGpio::do_set_status_led(bool on) {
  if (settings_.status_led_line == kNoLine) return {};
  if (!open_) return fail(settings_.status_led_line, "not open", 0);
  const int error = status_led_.set(on);
  return error == 0 ? Status{} : fail(settings_.status_led_line, "setting", error);
}

Result<bool> GpiodGpio::do_emergency_stop() {
  if (settings_.emergency_stop_line == kNoLine) return false;
  if (!open_) return fail(settings_.emergency_stop_line, "not open", 0);
  bool pulled = true;
  const int error = emergency_stop_.get(pulled);
  if (error == 0) return pulled;
  return fail(settings_.emergency_stop_line, "reading", error);
}

ErrorCode GpiodGpio::fail(int line, const char* doing, int error) {
  if (error == 0) {
    reason_.set("%s line %d: %s", settings_.chip.c_str(), line, doing);
    return ErrorCode::kDisconnected;
  }
  reason_.set("%s line %d: %s failed: %s", settings_.chip.c_str(), line, doing, system_text(error));
  return use_error(error);
}

}  // namespace touchline::hal
