#pragma once

#include <string>

#include "hal/linux/gpio/gpio_line.h"

// Error messages that both versions of libgpiod share.
namespace touchline::hal {

/// Returns the device of a chip that the board file names by its device or its label. A label stays the same if the
/// number changes with the kernel or the order of plugging in. kInconsistent: several chips have this label.
Result<std::string> find_chip(const std::string& named);
/// Error of opening a chip; lists the present chips if that helps.
Error chip_error(const std::string& chip, int error);
/// `label`: the name of the chip.
Error no_such_line(const std::string& chip, int line, const char* label, std::size_t lines);
/// Error of requesting a line. `holder`: its consumer, null if unknown; `input`: null for an output.
Error line_error(const std::string& chip, int line, int error, const char* holder, const GpioInput* input);
/// Sets O_NONBLOCK. 0 or an errno.
int make_nonblocking(int file);

}  // namespace touchline::hal
