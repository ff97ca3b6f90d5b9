#pragma once

#include <string>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline {

/// Draws the tops of all robots of the team file as a PNG file: patches with the names of their colors, the front
/// upwards. A color that the venue file calibrates is drawn as calibrated, any other color as its name says. kNotFound,
/// with file, line and key: there is no such layout. Other errors are those of hal::write_file().
Result<void> draw_layouts(const config::Configuration& configuration, const std::string& path);

}  // namespace touchline
