#pragma once

#include <span>
#include <string_view>

#include "firmware/config/radio_entry.h"

namespace touchline::config {

/// A file of boards/radios, which is part of the program.
struct RadioPreset {
  std::string_view name;  // for radio.format
  std::string_view toml;  // its content
};

/// All presets by name. "touchline" is not among them: core/radio defines it.
std::span<const RadioPreset> radio_presets();
/// Reads the preset `name` into `out`. False: there is none.
bool read_radio_preset(std::string_view name, RadioEntry& out);

}  // namespace touchline::config
