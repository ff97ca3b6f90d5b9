#pragma once

#include <string>

#include "core/status.h"

namespace touchline::config {

/// kIo, kPermission: it is there and cannot be read. A file that is not there is no error: `exists` says so.
Status read_text(const std::string& path, std::string& text, bool& exists, std::string& reason);

/// The new content appears at once or not at all, also when the power fails; the former file, if any, stays as
/// PATH.bak. A symbolic link stays a link, and the file keeps its permissions. kIo, kPermission.
Status replace_file(const std::string& path, const std::string& text, std::string& reason);

}  // namespace touchline::config
