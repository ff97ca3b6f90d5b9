#pragma once

#include <string>
#include <string_view>

#include "hal/result.h"

namespace touchline::config {

/// Replaces one section of a TOML file, or adds it at the end. All other bytes stay unchanged: order, comments, line
/// ends. For a list, all of its tables are one section: "color" is every [[color]] and [[color.box]]. Comments inside
/// the section are replaced, too, and a comment directly above its header if a blank line precedes it.
///
/// `toml` is the new section with its header ("[light]\nmap = \"light.png\"\n"); empty: the section is removed. A file
/// that does not exist is created. The former content is kept as PATH.bak; see replace_file().
///
/// kInconsistent: the file or `toml` is not valid TOML, `toml` has another section, or the file has the section in a
/// form without a header (`light = {...}`). kIo, kPermission, kNotFound: as hal::OutputFile. On error the file is
/// unchanged.
Result<void> write_section(const std::string& path, std::string_view section, std::string_view toml);

/// Content of a new file before the first section is added.
inline constexpr const char* kNewFile = "version = 1\n";

/// Returns the text that write_section() would write.
Result<std::string> replace_section(const std::string& text, std::string_view section, std::string_view toml);

}  // namespace touchline::config
