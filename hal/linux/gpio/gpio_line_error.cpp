#include "hal/linux/gpio/gpio_line_error.h"

#include <fcntl.h>

#include <cerrno>

#include "hal/linux/gpio/gpio_list.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

std::string chips_here() {
  std::string list;
  for (const GpioChipNode& chip : list_gpio_chips()) {
    const std::string lines = std::to_string(chip.line_count) + " lines";
    list.append(list.empty() ? "" : ", ").append(chip.path).append(" (");
    list.append(chip.error == 0 ? chip.label + ", " + lines : system_text(chip.error)).append(")");
  }
  return list.empty() ? "none" : list;
}

}  // namespace

Status find_chip(const std::string& named, std::string& device, Reason& reason) {
  device = named;
  if (named.find('/') != std::string::npos) return {};
  std::string found, refused;
  for (const GpioChipNode& chip : list_gpio_chips()) {
    if (chip.error == EACCES) refused = chip.path;
    if (chip.error != 0 || chip.label != named) continue;
    if (!found.empty()) {
      reason.set("%s: is both %s and %s; name one of them", named.c_str(), found.c_str(), chip.path.c_str());
      return ErrorCode::kInconsistent;
    }
    found = chip.path;
  }
  if (found.empty())
    return say_chip_refused(refused.empty() ? named : refused, refused.empty() ? ENOENT : EACCES, reason);
  device = found;
  return {};
}

Status say_chip_refused(const std::string& chip, int error, Reason& reason) {
  const ErrorCode code = open_error(error);
  if (code == ErrorCode::kPermission) return say_denied(reason, chip.c_str(), "gpio");
  if (code == ErrorCode::kNotFound) {
    reason.set("%s: no such chip; GPIO chips here: %s", chip.c_str(), chips_here().c_str());
    return code;
  }
  if (error == ENOTTY) {
    reason.set("%s: not a GPIO chip; GPIO chips here: %s", chip.c_str(), chips_here().c_str());
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

int make_nonblocking(int file) { return ::fcntl(file, F_SETFL, O_NONBLOCK) == 0 ? 0 : errno; }

}  // namespace touchline::hal
