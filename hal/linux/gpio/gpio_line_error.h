#pragma once

#include <string>

#include "hal/linux/gpio/gpio_line.h"

// What both versions of libgpiod have in common: the sentences.
namespace touchline::hal {

/// The device of the chip that a board file means: by its device already, or by its label, which stays where numbers
/// change with the kernel or the order of plugging in. kInconsistent: several have this label.
Status find_chip(const std::string& named, std::string& device, Reason& reason);
/// With a list of the chips that are here, where that helps.
Status say_chip_refused(const std::string& chip, int error, Reason& reason);
/// `label`: the chip's own name.
Status say_no_such_line(const std::string& chip, int line, const char* label, std::size_t lines, Reason& reason);
/// `holder`: who has the line, null when that is unknown; `input`: null for an output.
Status say_line_refused(const std::string& chip, int line, int error, const char* holder, const GpioInput* input,
                        Reason& reason);
/// The next read of a file answers EAGAIN instead of waiting. 0 or an errno.
int make_nonblocking(int file);

}  // namespace touchline::hal
