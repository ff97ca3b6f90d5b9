#pragma once

#include <string>
#include <vector>

#include "hal/result.h"

namespace touchline::log {

/// Writes recordings, or game logs, one after the other into a new file of the same format. Sessions of recordings get
/// new numbers; each is replayed as in its own file. Errors name the file.
Result<void> join(const std::vector<std::string>& inputs, const std::string& output);

}  // namespace touchline::log
