#pragma once

#include <string>

namespace touchline::hal {

/// The link of `folder` ("/dev/v4l/by-path") that leads to `device`, "" when there is none.
std::string stable_link(const char* folder, const std::string& device);

/// " = /dev/v4l/by-path/..." when `folder` has a link to `device`, else "". Such a name stays when devices are plugged
/// in another order; board files should hold it.
std::string stable_name(const char* folder, const std::string& device);

}  // namespace touchline::hal
