#pragma once

#include <span>
#include <string_view>

#include "firmware/config/locations.h"
#include "firmware/config/radio_entry.h"

namespace touchline::config {

/// A file of boards/radios, which is part of the program.
struct RadioPreset {
  std::string_view name;  // for radio.format
  std::string_view toml;  // its content
};

/// All presets by name. "touchline" is not among them: core/radio defines it.
std::span<const RadioPreset> radio_presets();
/// Reads the preset `name` into `out`, and the places of its keys into `where`. False: there is none.
bool read_radio_preset(std::string_view name, RadioEntry& out, Locations* where = nullptr);
/// Returns the places of the team file's keys, and for those of [radio] that it leaves to the preset `name`, the
/// preset's file and line and the place where the team file names it.
Locations locations_with_preset(const Locations& team, std::string_view name);

}  // namespace touchline::config
