#pragma once

#include <string>

namespace touchline::hal {

/// The link in `folder` ("/dev/v4l/by-path") to `device`; "" if there is none.
std::string stable_link(const char* folder, const std::string& device);

/// " = /dev/v4l/by-path/..." if `folder` has a link to `device`, else "". Board files should contain the link: it stays
/// the same when devices are plugged in in another order.
std::string stable_name(const char* folder, const std::string& device);

}  // namespace touchline::hal
