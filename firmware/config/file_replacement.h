#pragma once

#include <string>
#include <string_view>

#include "core/status.h"

namespace touchline::config {

/// Reads a text file. A file that does not exist is no error: `exists` tells. Errors of hal::read_file().
Status read_text(const std::string& path, std::string& text, bool& exists, std::string& reason);

/// Copies the file to PATH.bak, beside the target of a symbolic link. Nothing happens if there is no file.
Status back_up(const std::string& path, std::string& reason);

/// Replaces the file by an hal::OutputFile and keeps the former content as PATH.bak. Errors of OutputFile.
Status replace_file(const std::string& path, std::string_view text, std::string& reason);

}  // namespace touchline::config
