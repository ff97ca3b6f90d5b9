#pragma once

#include <string>

#include "core/light/light_map.h"
#include "core/status.h"

namespace touchline::config {

/// The value in the file that means illumination 1.
inline constexpr double kUnitIllumination = 32768.0;

/// Reads an illumination map: a PNG with 16 bits per channel, one pixel per cell, at most kMaxLightCells cells.
/// On error `reason` says what is wrong with the file. kNotFound, kPermission, kIo, kCorruptFrame, kUnsupported: as
/// hal::read_picture(), kUnsupported also for 8 bits; kOutOfRange: too many cells, or one without light.
Status read_light_map(const std::string& path, LightMap& out, std::string& reason);

}  // namespace touchline::config
