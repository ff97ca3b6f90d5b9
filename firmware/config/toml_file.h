#pragma once

#include <toml++/toml.h>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "firmware/config/problems.h"
#include "firmware/config/toml_reader.h"

namespace touchline::config {

/// One `--set key=value`.
struct Override {
  std::string key;    // path of the key: "camera.exposure_us", "color[2].name"
  std::string value;  // TOML; anything else is read as a string
};

/// Parses a file. On error, adds a problem and returns nothing. `remedy` is added to the message if there is no file.
std::optional<toml::table> parse_file(const std::string& path, std::string_view remedy, Problems& problems);

/// Checks the version. On error, adds a problem and returns false.
bool check_version(const toml::table& root, const std::string& path, Problems& problems);

/// Stores the value in the table. The reader checks it later like a value from the file.
void apply(const Override& override, toml::table& root, Problems& problems);

/// Reads a file and checks all keys. Keys with a wrong value keep their default.
/// kNotFound: the file does not exist or has another version; nothing was read. kInconsistent: values are wrong. Both
/// add problems.
template <class File>
Status read_toml(const std::string& path, std::string_view remedy, std::span<const Override> overrides, File& out,
                 Locations& locations, Problems& problems) {
  const std::size_t before = problems.size();
  locations = Locations(path);
  std::optional<toml::table> root = parse_file(path, remedy, problems);
  if (!root) return ErrorCode::kNotFound;
  if (!check_version(*root, path, problems)) return ErrorCode::kNotFound;
  for (const Override& override : overrides) apply(override, *root, problems);
  TomlReader reader(*root, File::kRequired, locations, problems);
  reader.read(out);
  return problems.size() == before ? Status() : ErrorCode::kInconsistent;
}

}  // namespace touchline::config
