#pragma once

#include <string>

#include "hal/result.h"

namespace touchline::log {

/// Returns lines that tell what a recording or game log holds: times, sessions, reloads, gaps, halts, goals, and the
/// messages of each channel. Errors name the file and the byte.
Result<std::string> list(const std::string& input);

}  // namespace touchline::log
