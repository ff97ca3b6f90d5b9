#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

/// "/dev/video" -> "/dev/video0", "/dev/video2", "/dev/video10": the files whose names are `name` and a number, sorted
/// by number.
std::vector<std::string> numbered_files(const std::string& name);

/// True if `file` is `name` followed by a number.
bool is_numbered(const std::string& file, const std::string& name);

/// True if `file` is a link to another file.
bool leads_elsewhere(const std::string& file);

}  // namespace touchline::hal
