#pragma once

#include <string>
#include <string_view>

#include "core/status.h"

namespace touchline::config {

/// Replaces all of one section of a TOML file (for lists all of its tables: "color" is every [[color]] and
/// [[color.box]]), or adds it at the end. Everything else stays as it is to the byte: order, comments, line ends. A
/// comment right above a section belongs to it when it follows a blank line; a section's own comments go with it.
///
/// `toml` holds the section with its header ("[light]\nmap = \"light.png\"\n"), empty: the section is removed. A file
/// that does not exist is begun with `version = 1`. The former file stays beside it as PATH.bak; the new one appears at
/// once or not at all (written, synced, renamed).
///
/// kIo, kPermission: the file system. kInconsistent: the file is no TOML, `toml` is none or holds another section, or
/// the file has the section in a form without header (`light = {...}`). On error the file is as it was and `reason`
/// tells file and cause.
Status write_section(const std::string& path, std::string_view section, std::string_view toml, std::string& reason);

/// The text of a new file.
inline constexpr const char* kNewFile = "version = 1\n";

/// The text that write_section() would write; for tools that show it first.
Status replace_section(const std::string& text, std::string_view section, std::string_view toml, std::string& out,
                       std::string& reason);

}  // namespace touchline::config
