#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "hal/result.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// A JSON number, text, flag or list as TOML; a number that is not whole is rounded to single precision, like the keys
/// that the page shows. kInconsistent: anything else.
Result<std::string> toml_of(const nlohmann::json& value);

/// Returns the text of a TOML file with this key set, or removed if `toml_value` is empty. All else stays; only if the
/// key's table has no header, its section is written anew and loses its comments. kInconsistent: the path does not
/// exist, or the section has no header of its own.
Result<std::string> replace_key(const std::string& text, const std::string& key, const std::string& toml_value);

/// The file of a key: "camera.gain" belongs to the board file; "board.", "venue." and "team." in front name the file
/// and are removed. kNotFound: no file has such a key.
Result<std::string> file_of_key(const SetupFiles& files, std::string& key);

}  // namespace touchline::setup
