#pragma once

#include <string>

#include "core/light/light_map.h"
#include "hal/result.h"

namespace touchline::config {

/// The value in the file that means illumination 1.
inline constexpr double kUnitIllumination = 32768.0;

/// Reads an illumination map: a PNG with 16 bits per channel, one pixel per cell, at most kMaxLightCells cells.
/// kNotFound, kPermission, kIo, kCorruptFrame, kUnsupported: as
/// hal::read_picture(), kUnsupported also for 8 bits; kOutOfRange: too many cells, or one without light.
Result<void> read_light_map(const std::string& path, LightMap& out);

}  // namespace touchline::config
