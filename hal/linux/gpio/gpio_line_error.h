#pragma once

#include <string>

#include "hal/linux/gpio/gpio_line.h"

// Error messages for both versions of libgpiod.
namespace touchline::hal {

/// Returns the device of a chip that is named by its device or by its label. Unlike the number in the device's name, a
/// label does not depend on the kernel or the order of plugging in. kInconsistent: several chips have this label.
Result<std::string> find_chip(const std::string& named);
/// Error of opening a chip. If it does not exist or is not a GPIO chip, the message lists the available chips.
Error chip_error(const std::string& chip, int error);
/// `label`: label of the chip; `lines`: number of its lines.
Error no_such_line(const std::string& chip, int line, const char* label, std::size_t lines);
/// Error of requesting a line. `holder`: consumer that uses the line, null if unknown; `input`: null for an output.
Error line_error(const std::string& chip, int line, int error, const char* holder, const GpioInput* input);
/// Sets O_NONBLOCK. Returns 0 or an errno.
int make_nonblocking(int file);

}  // namespace touchline::hal
