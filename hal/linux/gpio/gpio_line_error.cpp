#include "hal/linux/gpio/gpio_line_error.h"

#include <fcntl.h>

#include <cerrno>

#include "hal/linux/gpio/gpio_list.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

std::string available_chips() {
  std::string list;
  for (const GpioChipNode& chip : list_gpio_chips()) {
    const std::string lines = std::to_string(chip.line_count) + " lines";
    list.append(list.empty() ? "" : ", ").append(chip.path).append(" (");
    list.append(chip.error == 0 ? chip.label + ", " + lines : system_text(chip.error)).append(")");
  }
  return list.empty() ? "none" : list;
}

}  // namespace

Result<std::string> find_chip(const std::string& named) {
  if (named.find('/') != std::string::npos) return named;
  std::string found, refused;
  for (const GpioChipNode& chip : list_gpio_chips()) {
    if (chip.error == EACCES) refused = chip.path;
    if (chip.error != 0 || chip.label != named) continue;
    if (!found.empty()) {
      return failure(ErrorCode::kInconsistent, "%s: is the label of both %s and %s; use one of these names",
                     named.c_str(), found.c_str(), chip.path.c_str());
    }
    found = chip.path;
  }
  if (found.empty()) return chip_error(refused.empty() ? named : refused, refused.empty() ? ENOENT : EACCES);
  return found;
}

Error chip_error(const std::string& chip, int error) {
  const ErrorCode code = open_error(error);
  if (code == ErrorCode::kPermission) return permission_denied(chip.c_str(), "gpio");
  if (code == ErrorCode::kNotFound) {
    return failure(code, "%s: no such chip; available GPIO chips: %s", chip.c_str(), available_chips().c_str());
  }
  if (error == ENOTTY) {
    return failure(ErrorCode::kUnsupported, "%s: not a GPIO chip; available GPIO chips: %s", chip.c_str(),
                   available_chips().c_str());
  }
  return failure(code, "%s: cannot be opened: %s", chip.c_str(), system_text(error));
}

Error no_such_line(const std::string& chip, int line, const char* label, std::size_t lines) {
  return failure(ErrorCode::kNotFound, "%s line %d: no such line; the chip (%s) has lines 0 to %zu", chip.c_str(), line,
                 label, lines - 1);
}

Error line_error(const std::string& chip, int line, int error, const char* holder, const GpioInput* input) {
  if (error == EBUSY) {
    return failure(open_error(error), "%s line %d: in use by \"%s\"; `gpioinfo` lists the users of all lines",
                   chip.c_str(), line, holder != nullptr ? holder : "the kernel");
  }
  if (input != nullptr && input->bias != GpioBias::kNone && (error == EINVAL || error == EOPNOTSUPP)) {
    return failure(ErrorCode::kUnsupported,
                   "%s line %d: the kernel cannot set a bias for this line; set %s = \"none\" and add a resistor",
                   chip.c_str(), line, input->bias_key);
  }
  return failure(open_error(error), "%s line %d: cannot be requested: %s", chip.c_str(), line, system_text(error));
}

int make_nonblocking(int file) { return ::fcntl(file, F_SETFL, O_NONBLOCK) == 0 ? 0 : errno; }

}  // namespace touchline::hal
