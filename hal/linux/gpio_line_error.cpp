#include "hal/linux/gpio_line_error.h"

#include <fcntl.h>

#include <cerrno>

#include "hal/linux/system_error.h"

namespace touchline::hal {

Status say_chip_refused(const std::string& chip, int error, const std::string& chips, Reason& reason) {
  const ErrorCode code = open_error(error);
  if (code == ErrorCode::kPermission) return say_denied(reason, chip.c_str(), "gpio");
  const char* const list = chips.empty() ? "none" : chips.c_str();
  if (code == ErrorCode::kNotFound) {
    reason.set("%s: no such chip; GPIO chips here: %s", chip.c_str(), list);
    return code;
  }
  if (error == ENOTTY) {
    reason.set("%s: not a GPIO chip; GPIO chips here: %s", chip.c_str(), list);
    return ErrorCode::kUnsupported;
  }
  reason.set("%s: cannot be opened: %s", chip.c_str(), system_text(error));
  return code;
}

Status say_no_such_line(const std::string& chip, int line, const char* label, std::size_t lines, Reason& reason) {
  reason.set("%s line %d: no such line; the chip (%s) has lines 0 to %zu", chip.c_str(), line, label, lines - 1);
  return ErrorCode::kNotFound;
}

Status say_line_refused(const std::string& chip, int line, int error, const char* holder, const GpioInput* input,
                        Reason& reason) {
  if (error == EBUSY) {
    reason.set("%s line %d: held by \"%s\"; `gpioinfo` lists who holds what", chip.c_str(), line,
               holder != nullptr ? holder : "the kernel");
  } else if (input != nullptr && input->bias != GpioBias::kNone && (error == EINVAL || error == EOPNOTSUPP)) {
    reason.set("%s line %d: the kernel has no bias for it; set %s = \"none\" and fit a resistor", chip.c_str(), line,
               input->bias_key);
    return ErrorCode::kUnsupported;
  } else {
    reason.set("%s line %d: cannot be requested: %s", chip.c_str(), line, system_text(error));
  }
  return open_error(error);
}

void append_chip(std::string& list, const std::string& name, const char* label, std::size_t lines) {
  if (!list.empty()) list += ", ";
  list += "/dev/" + name + " (" + label + ", " + std::to_string(lines) + " lines)";
}

int make_nonblocking(int file) { return ::fcntl(file, F_SETFL, O_NONBLOCK) == 0 ? 0 : errno; }

}  // namespace touchline::hal
