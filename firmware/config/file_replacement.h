#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hal/result.h"

namespace touchline::config {

/// Reads a text file; nothing if it does not exist. Errors of hal::read_file() but kNotFound.
Result<std::optional<std::string>> read_text(const std::string& path);

/// Copies the file to PATH.bak, in the folder of the target of a symbolic link. Does nothing if there is no file.
Result<void> back_up(const std::string& path);

/// Replaces the file with an hal::OutputFile and keeps the former content as PATH.bak. Errors of OutputFile.
Result<void> replace_file(const std::string& path, std::string_view text);

}  // namespace touchline::config
