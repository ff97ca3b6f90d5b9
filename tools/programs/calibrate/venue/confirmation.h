#pragma once

#include <string>

namespace touchline::calibrate {

/// Asks a yes-or-no question at the terminal. Returns false if standard input is not a terminal.
bool confirmed(const std::string& question);

}  // namespace touchline::calibrate
