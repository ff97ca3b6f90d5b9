#pragma once

#include <toml++/toml.h>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/error_list.h"
#include "firmware/config/locations.h"
#include "firmware/config/toml_reader.h"

namespace touchline::config {

/// One `--set key=value`, or `--set key+=list`.
struct Override {
  std::string key;       // path of the key: "camera.exposure_us", "color[2].name"
  std::string value;     // TOML; anything else is read as a string
  bool appends = false;  // the elements of the list `value` follow those that the key has already
};

/// The option as it was given.
std::string option_text(const Override& override);

/// Parses a file and checks its version. kNotFound: see read_toml(). `remedy` is added to the message if there is no
/// file.
Result<toml::table> parse_file(const std::string& path, std::string_view remedy);
/// As above for `content`, the content of the file `path`.
Result<toml::table> parse_text(std::string_view content, const std::string& path);

/// Stores the value in the table, or adds it to the list there. The reader checks it later like a value from the file.
Result<void> apply(const Override& override, toml::table& root);

/// Checks all keys of a parsed file, and stores their values. `required`: see TomlReader.
template <class File>
Result<void> read_table(toml::table& root, std::span<const Override> overrides, File& out, Locations& locations,
                        std::span<const std::string_view> required = File::kRequired) {
  ErrorList errors;
  for (const Override& override : overrides) errors.add(apply(override, root));
  // The keys of a preset count before those of the file.
  if constexpr (requires { File::kPresetKey; }) {
    read_preset(root.at_path(File::kPresetKey).value_or(std::string_view()), out);
  }
  TomlReader reader(root, required, locations, errors);
  reader.read(out);
  return errors.result();
}

/// Reads a file and checks all keys. Keys with a wrong value keep their default.
/// kNotFound: the file does not exist, is not TOML or has another version; nothing was read. kInconsistent: values are
/// wrong; the message has a line for each.
template <class File>
Result<void> read_toml(const std::string& path, std::string_view remedy, std::span<const Override> overrides, File& out,
                       Locations& locations, std::span<const std::string_view> required = File::kRequired) {
  locations = Locations(path);
  TOUCHLINE_TRY_ASSIGN(toml::table root, parse_file(path, remedy));
  return read_table(root, overrides, out, locations, required);
}

}  // namespace touchline::config
