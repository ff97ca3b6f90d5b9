#pragma once

#include <string>

#include "core/light/light_map.h"
#include "core/light/light_reference.h"
#include "hal/result.h"

namespace touchline::config {

/// Value in the file that stands for illumination 1.
inline constexpr double kUnitIllumination = 32768.0;

/// Reads an illumination map: a PNG with 16 bits per channel, one pixel per cell, at most kMaxLightCells cells.
/// kNotFound, kPermission, kIo, kCorruptFrame, kUnsupported: as hal::read_picture(), kUnsupported also for 8 bits;
/// kOutOfRange: there are too many cells, or one has no light.
Result<void> read_light_map(const std::string& path, LightMap& out);

/// Reads a reference of the field for pictures of this size: a PNG with 16 bits per channel, one pixel per cell of
/// ReferenceGrid, with 256 times the mean value of the cell, 0 if it is unusable. Errors of hal::read_picture(),
/// kUnsupported also for 8 bits; kInconsistent: the number of cells belongs to pictures of another size.
Result<void> read_light_reference(const std::string& path, std::uint16_t width_px, std::uint16_t height_px,
                                  LightReference& out);
/// Returns the PNG file of a map, from which the same map is read. Errors of hal::encode_png().
Result<std::string> encode_light_map(const LightMap& map);
/// Returns the PNG file of a reference. Errors of hal::encode_png().
Result<std::string> encode_light_reference(const LightReference& reference);

}  // namespace touchline::config
