#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

/// Returns the files whose names are `name` and a number, sorted by number: "/dev/video" gives "/dev/video0",
/// "/dev/video2", "/dev/video10".
std::vector<std::string> numbered_files(const std::string& name);

/// Returns true if `file` is `name` followed by a number.
bool is_numbered(const std::string& file, const std::string& name);

/// Returns true if `file` is a symbolic link to another file.
bool is_link(const std::string& file);

/// Returns the link in `folder` ("/dev/v4l/by-path") to `device`; "" if there is none. Board files should contain the
/// link, because it stays the same if devices are plugged in in another order.
std::string stable_link(const char* folder, const std::string& device);

/// Returns the processes that have this device open, as far as this user may see them: "guvcview (process 1234)"; "" if
/// none is visible. Reads /proc.
std::string users_of(const std::string& device);

}  // namespace touchline::hal
