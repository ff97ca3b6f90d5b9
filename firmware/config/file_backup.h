#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hal/result.h"

namespace touchline::config {

/// Reads a text file. Empty if it does not exist. Errors: those of hal::read_file() except kNotFound.
Result<std::optional<std::string>> read_text(const std::string& path);
/// As above, for any file of at most hal::kMaxDataFileBytes.
Result<std::optional<std::string>> read_data(const std::string& path);

/// Copies the file to PATH.bak. If it is a symbolic link, the copy is beside its target. Does nothing if there is no
/// file.
Result<void> back_up(const std::string& path);

/// Replaces the file with hal::OutputFile and keeps the former content as PATH.bak. Errors: those of OutputFile.
Result<void> replace_file(const std::string& path, std::string_view text);

}  // namespace touchline::config
