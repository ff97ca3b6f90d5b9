#pragma once

#include <string>

#include "hal/linux/gpio_line.h"

// What both versions of libgpiod have in common: the sentences.
namespace touchline::hal {

/// `chips`: those that are here.
Status say_chip_refused(const std::string& chip, int error, const std::string& chips, Reason& reason);
/// `label`: the chip's own name.
Status say_no_such_line(const std::string& chip, int line, const char* label, std::size_t lines, Reason& reason);
/// `holder`: who has the line, null when that is unknown; `input`: null for an output.
Status say_line_refused(const std::string& chip, int line, int error, const char* holder, const GpioInput* input,
                        Reason& reason);
/// An entry of the list of chips.
void append_chip(std::string& list, const std::string& name, const char* label, std::size_t lines);
/// The next read of a file answers EAGAIN instead of waiting. 0 or an errno.
int make_nonblocking(int file);

}  // namespace touchline::hal
