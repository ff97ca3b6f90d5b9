#pragma once

#include <string>

#include "hal/linux/gpio/gpio_line.h"

// Error messages that both versions of libgpiod share.
namespace touchline::hal {

/// The device of the chip that a board file means: by its device already, or by its label, which stays where numbers
/// change with the kernel or the order of plugging in. kInconsistent: several have this label.
Result<std::string> find_chip(const std::string& named);
/// With a list of the chips that are here, where that helps.
Error chip_error(const std::string& chip, int error);
/// `label`: the chip's own name.
Error no_such_line(const std::string& chip, int line, const char* label, std::size_t lines);
/// `holder`: who has the line, null when that is unknown; `input`: null for an output.
Error line_error(const std::string& chip, int line, int error, const char* holder, const GpioInput* input);
/// The next read of a file answers EAGAIN instead of waiting. 0 or an errno.
int make_nonblocking(int file);

}  // namespace touchline::hal
