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
  std::string value;  // TOML, or a bare word, which is a text
};

/// The syntax tree, or nothing and a problem with the line. `remedy` is what to do when there is no such file.
std::optional<toml::table> parse_file(const std::string& path, std::string_view remedy, Problems& problems);

/// False, with a problem, when the file has no version or one that this program does not read.
bool check_version(const toml::table& root, const std::string& path, Problems& problems);

/// Puts the value where a file would have it; what it means is checked by the reading that follows.
void apply(const Override& override, toml::table& root, Problems& problems);

/// Reads one of the three files with all its keys checked. Values that are wrong keep their default.
/// kNotFound: no such file, or none of this format and version; nothing was read. kInconsistent: values are wrong. Both
/// have added problems.
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
