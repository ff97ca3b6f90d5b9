#include "firmware/config/light_writer.h"

#include <toml++/toml.h>

#include <filesystem>

#include "firmware/config/file_backup.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/toml_writer.h"
#include "hal/files/output_file.h"

namespace touchline::config {
namespace {

namespace fs = std::filesystem;

// Returns the map that the venue file names; empty if it names none. The text must be valid TOML.
std::string map_of(const std::string& text) { return toml::parse(text)["light"]["map"].value_or(std::string()); }

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return a.lexically_normal() == b.lexically_normal() || fs::equivalent(a, b, error);
}

std::string free_name(const fs::path& venue, const std::string& kind, const std::string& in_use) {
  const fs::path folder = venue.parent_path();
  const std::string first = venue.stem().string() + "-" + kind + ".png";
  return same_file(folder / in_use, folder / first) ? venue.stem().string() + "-" + kind + "-2.png" : first;
}

}  // namespace

Result<std::string> write_light(const std::string& venue, std::string_view png, LightEntry entry) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, read_text(venue));
  const std::string former = text.value_or(kNewFile);
  const fs::path folder = fs::path(venue).parent_path();
  const auto changed_file = [&] {
    return replace_section(former, "light", "[light]\n" + TomlWriter::text_of(entry, false));
  };
  // Report an invalid file before anything is written.
  Result<std::string> changed = changed_file();
  if (!changed.ok()) return prefixed(venue, std::move(changed).error());
  TOUCHLINE_TRY_ASSIGN(entry.map, write_venue_picture(venue, "light", map_of(former), png));
  changed = changed_file();
  TOUCHLINE_TRY(replace_file(venue, changed.value()));
  return (folder / entry.map).string();
}

Result<std::string> write_venue_picture(const std::string& venue, const std::string& kind, const std::string& in_use,
                                        std::string_view png) {
  const std::string name = free_name(venue, kind, in_use);
  // Write the backup first, because the previous one may name the picture that is about to be replaced.
  TOUCHLINE_TRY(back_up(venue));
  TOUCHLINE_TRY(hal::write_file((fs::path(venue).parent_path() / name).string(), png));
  return name;
}

}  // namespace touchline::config
