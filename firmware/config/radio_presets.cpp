#include "firmware/config/radio_presets.h"

#include <algorithm>
#include <array>

#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"

namespace touchline::config {
namespace {

// A file of boards/radios.
struct PresetFile {
  int version = kFileVersion;
  RadioEntry radio;

  static constexpr std::array<std::string_view, 1> kRequired{"radio"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.version, {.name = "version", .range = kVersionRange, .help = "Version of the file format"});
    visit.section(self.radio, {.name = "radio", .help = "What the robots understand"});
  }
};

}  // namespace

bool read_radio_preset(std::string_view name, RadioEntry& out, Locations* where) {
  const auto presets = radio_presets();
  const auto found =
      std::find_if(presets.begin(), presets.end(), [&](const RadioPreset& preset) { return preset.name == name; });
  if (found == presets.end()) return false;
  const std::string path = "boards/radios/" + std::string(name) + ".toml";
  Result<toml::table> root = parse_text(found->toml, path);
  if (!root.ok()) return false;
  PresetFile file;
  Locations own_locations;
  Locations& locations = where != nullptr ? *where : own_locations;
  locations = Locations(path);
  if (!read_table(root.value(), {}, file, locations).ok()) return false;
  out = file.radio;
  return true;
}

Locations locations_with_preset(const Locations& team, std::string_view name) {
  Locations all = team, preset;
  RadioEntry read;
  if (!read_radio_preset(name, read, &preset)) return all;
  const std::string chosen = " (radio.format = \"" + std::string(name) + "\" of " + team.of("radio.format") + ")";
  for (const auto& [key, where] : preset.all()) {
    const std::size_t begin = key.find('.');
    if (begin == std::string::npos) continue;
    // A list of the team file replaces that of the preset.
    const std::string member = key.substr(0, key.find_first_of(".[", begin + 1));
    if (!team.has(member) && !team.has(member + "[0]")) all.note(key, where + chosen);
  }
  return all;
}

void read_preset(std::string_view name, TeamFile& out) { read_radio_preset(name, out.radio); }

}  // namespace touchline::config
