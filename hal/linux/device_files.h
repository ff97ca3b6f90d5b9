#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

/// "/dev/video" -> "/dev/video0", "/dev/video2", "/dev/video10": the files of this name and a number, by the number.
std::vector<std::string> numbered_files(const std::string& name);

/// Whether `file` is `name` and a number.
bool is_numbered(const std::string& file, const std::string& name);

/// Whether it is a link to another file.
bool leads_elsewhere(const std::string& file);

}  // namespace touchline::hal
