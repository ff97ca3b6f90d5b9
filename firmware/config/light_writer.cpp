#include "firmware/config/light_writer.h"

#include <toml++/toml.h>

#include <filesystem>

#include "firmware/config/file_replacement.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/toml_writer.h"
#include "hal/linux/files/output_file.h"

namespace touchline::config {
namespace {

namespace fs = std::filesystem;

// The map that a venue file names; empty if it names none. The text is valid TOML.
std::string map_of(const std::string& text) { return toml::parse(text)["light"]["map"].value_or(std::string()); }

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return a.lexically_normal() == b.lexically_normal() || fs::equivalent(a, b, error);
}

}  // namespace

Result<std::string> write_light(const std::string& venue, std::string_view png, LightEntry entry) {
  std::string former, changed, reason;
  bool exists = false;
  if (const Status status = read_text(venue, former, exists, reason); !status.ok()) return Error{status.code(), reason};
  if (!exists) former = kNewFile;
  const fs::path folder = fs::path(venue).parent_path();
  const auto section = [&entry] { return "[light]\n" + TomlWriter::text_of(entry, false); };
  entry.map = fs::path(venue).stem().string() + "-light.png";
  // This also checks that the file is TOML, and that its section can be replaced.
  Status status = replace_section(former, "light", section(), changed, reason);
  if (status.ok() && same_file(folder / map_of(former), folder / entry.map)) {
    entry.map = fs::path(venue).stem().string() + "-light-2.png";
    status = replace_section(former, "light", section(), changed, reason);
  }
  if (!status.ok()) return Error{status.code(), venue + ": " + reason};

  const std::string map = (folder / entry.map).string();
  // The former backup may name the map that is going to be replaced.
  status = back_up(venue, reason);
  if (status.ok()) status = hal::write_file(map, png, reason);
  if (status.ok()) status = replace_file(venue, changed, reason);
  if (!status.ok()) return Error{status.code(), reason};
  return map;
}

}  // namespace touchline::config
