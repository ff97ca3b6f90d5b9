#pragma once

#include <string>

#include "hal/result.h"

namespace touchline::testing {

/// Writes the frames on which profile_step runs the step, in a pixel format or as "mjpg", into a file. `picture`:
/// "game" in the arena of the mock board, or the name of a picture of latency::worst_clutter(). `venue`: a venue file
/// of the format's color space; it is not used for "mjpg". kNotFound: no such picture.
Result<void> store_pictures(const std::string& picture, const std::string& format, const std::string& venue,
                            const std::string& file);

}  // namespace touchline::testing
