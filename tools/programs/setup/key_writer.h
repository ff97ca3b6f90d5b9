#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "hal/result.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// Converts a JSON number, text, flag or list to TOML; a number that is not whole is rounded to single precision, like
/// the keys that the page shows. kInconsistent: anything else.
Result<std::string> toml_of(const nlohmann::json& value);

/// Returns the text of a TOML file with this key set, or removed if `toml_value` is empty. The rest of the text stays;
/// only if the key's table has no header, its section is written anew and loses its comments. kInconsistent: the path
/// does not exist, or the section has no header of its own.
Result<std::string> replace_key(const std::string& text, const std::string& key, const std::string& toml_value);

/// Returns the file of a key: "camera.gain" belongs to the board file; a prefix "board.", "venue." or "team." names the
/// file and is removed from `key`. kNotFound: no file has such a key.
Result<std::string> file_of_key(const SetupFiles& files, std::string& key);

}  // namespace touchline::setup
