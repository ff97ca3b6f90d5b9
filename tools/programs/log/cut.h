#pragma once

#include <string>

#include "hal/result.h"

namespace touchline::log {

/// A stretch of a recording, in seconds from its first step (of a game log: from its first message).
struct Stretch {
  double from_s = 0.0, to_s = 0.0;
};

/// Copies a stretch of a recording or game log into a new file of the same format. A recording begins with a frame and
/// with the configuration in force there, including former reloads, so that it can be replayed. Errors name the file;
/// kNotFound: nothing lies in the stretch.
Result<void> cut(const std::string& input, const Stretch& stretch, const std::string& output);

}  // namespace touchline::log
