// libgpiod 1.x
#include <gpiod.h>

#include <cerrno>

#include "hal/linux/gpio_line.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

constexpr const char* kConsumer = "touchline";

std::string chips_here() {
  gpiod_chip_iter* const chips = gpiod_chip_iter_new();
  if (chips == nullptr) return "none";
  std::string list;
  for (gpiod_chip* chip = gpiod_chip_iter_next(chips); chip != nullptr; chip = gpiod_chip_iter_next(chips)) {
    if (!list.empty()) list += ", ";
    list += std::string("/dev/") + gpiod_chip_name(chip) + " (" + gpiod_chip_label(chip) + ", " +
            std::to_string(gpiod_chip_num_lines(chip)) + " lines)";
  }
  gpiod_chip_iter_free(chips);
  return list.empty() ? "none" : list;
}

int bias_flag(GpioBias bias) {
  switch (bias) {
    case GpioBias::kPullUp:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioBias::kPullDown:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case GpioBias::kNone:
      break;
  }
  return 0;  // as the chip has it: kernels before 5.5 refuse every bias flag
}

}  // namespace

Status GpioLine::find(const std::string& chip, int line, Reason& reason) {
  release();
  chip_ = gpiod_chip_open(chip.c_str());
  if (chip_ == nullptr) {
    const int error = errno;
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kPermission) return say_denied(reason, chip.c_str(), "gpio");
    if (code == ErrorCode::kNotFound) {
      reason.set("%s: no such chip; GPIO chips here: %s", chip.c_str(), chips_here().c_str());
    } else if (error == ENOTTY) {
      reason.set("%s: not a GPIO chip; GPIO chips here: %s", chip.c_str(), chips_here().c_str());
      return ErrorCode::kUnsupported;
    } else {
      reason.set("%s: cannot be opened: %s", chip.c_str(), system_text(error));
    }
    return code;
  }
  line_ = gpiod_chip_get_line(chip_, static_cast<unsigned>(line));
  if (line_ == nullptr) {
    const int error = errno;
    if (error == EINVAL) {
      reason.set("%s line %d: no such line; the chip (%s) has lines 0 to %u", chip.c_str(), line,
                 gpiod_chip_label(chip_), gpiod_chip_num_lines(chip_) - 1);
    } else {
      reason.set("%s line %d: cannot be found: %s", chip.c_str(), line, system_text(error));
    }
    release();
    return error == EINVAL ? ErrorCode::kNotFound : use_error(error);
  }
  return {};
}

Status GpioLine::request_output(const std::string& chip, int line, Reason& reason) {
  if (const Status status = find(chip, line, reason); !status.ok()) return status;
  if (gpiod_line_request_output(line_, kConsumer, 0) == 0) return {};
  return refused(chip, line, errno, GpioBias::kNone, reason);
}

Status GpioLine::request_input(const std::string& chip, int line, bool active_low, GpioBias bias, Reason& reason) {
  if (const Status status = find(chip, line, reason); !status.ok()) return status;
  const int flags = bias_flag(bias) | (active_low ? int{GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW} : 0);
  if (gpiod_line_request_input_flags(line_, kConsumer, flags) == 0) return {};
  return refused(chip, line, errno, bias, reason);
}

Status GpioLine::refused(const std::string& chip, int line, int error, GpioBias bias, Reason& reason) {
  ErrorCode code = open_error(error);
  if (error == EBUSY) {
    const char* const holder = gpiod_line_consumer(line_);
    reason.set("%s line %d: held by \"%s\"; `gpioinfo` lists who holds what", chip.c_str(), line,
               holder != nullptr ? holder : "the kernel");
  } else if (error == EINVAL && bias != GpioBias::kNone) {
    reason.set("%s line %d: the kernel has no bias for it; set emergency_stop_bias = \"none\" and fit a resistor",
               chip.c_str(), line);
    code = ErrorCode::kUnsupported;
  } else {
    reason.set("%s line %d: cannot be requested: %s", chip.c_str(), line, system_text(error));
  }
  release();
  return code;
}

void GpioLine::release() {
  if (chip_ != nullptr) gpiod_chip_close(chip_);  // releases its lines
  chip_ = nullptr;
  line_ = nullptr;
}

int GpioLine::set(bool active) const { return gpiod_line_set_value(line_, active ? 1 : 0) == 0 ? 0 : errno; }

int GpioLine::get(bool& active) const {
  const int value = gpiod_line_get_value(line_);
  active = value == 1;
  return value < 0 ? errno : 0;
}

}  // namespace touchline::hal
