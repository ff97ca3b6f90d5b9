#pragma once

#include <string>

namespace touchline {

/// Returns whether writing `output` would replace `input`, or add a picture to it if it is a folder. Neither file needs
/// to exist; an empty path is no file, and a device such as /dev/null has nothing to replace.
bool would_overwrite(const std::string& input, const std::string& output);

}  // namespace touchline
