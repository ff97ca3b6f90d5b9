#pragma once

#include <array>
#include <cstdint>

#include "core/light/light_change.h"
#include "core/light/light_map.h"
#include "core/types.h"

namespace touchline {

// The gain is constant within a tile, so kernels change tables only between tiles. Tile sizes are even, so pixels that
// share a chroma sample lie in the same tile.
constexpr std::uint16_t kTileWidth = 16, kTileHeight = 8;
constexpr std::size_t kMaxTileRows = (kMaxFrameHeight + kTileHeight - 1) / kTileHeight;
constexpr std::size_t kMaxTiles = ((kMaxFrameWidth + kTileWidth - 1) / kTileWidth) * kMaxTileRows;

// Gains are quantized to levels of 1/32 octave (2.2 %, below the noise of a pixel). Level 64 is a gain of 1; the range
// is 1/4 to 4.
constexpr std::uint8_t kLightLevels = 128, kNeutralLevel = 64;

/// Returns the gain of a level, 2^((level - 64) / 32). Range of level: below kLightLevels.
float gain_of_level(std::uint8_t level);

/// Returns the level whose gain is nearest to `gain` by ratio. Gains outside the range get the first or the last level.
/// Range of gain: above 0.
std::uint8_t level_of_gain(float gain);

/// The largest value that a camera delivers. Brighter light gives the same value.
constexpr std::uint8_t kFullScale = 255;

/// Corrects a channel's value: round(black + (value - black) * gain), clamped to 0..255. It never decreases when the
/// value grows.
std::uint8_t corrected(std::uint8_t value, std::uint8_t level, std::uint8_t black);
/// Returns corrected() of every value.
std::array<std::uint8_t, 256> corrected_values(std::uint8_t level, std::uint8_t black);

/// Gain of eq. (17) as one level per tile: 1 / illumination at the center of the tile. It is interpolated bilinearly
/// between the cells of the map and constant outside the outermost cell centers.
class Shading {
 public:
  /// A map without columns turns the correction off. In YUV all three channels have the same level, from the luminance
  /// of the map (ITU-R BT.601 weights). kOutOfRange: an illumination is not positive and finite, the map has columns
  /// but no rows or more cells than the capacity, or the picture is empty or larger than the capacity. After an error
  /// the correction is off.
  Status build(const LightMap& map, std::uint16_t width_px, std::uint16_t height_px, ColorSpace space);
  void clear() { active_ = false; }
  [[nodiscard]] bool active() const { return active_; }
  /// Returns the level of channel 0, 1 or 2 in tile (u / kTileWidth, v / kTileHeight). Only valid if active().
  [[nodiscard]] std::uint8_t level(std::size_t channel, std::uint16_t column, std::uint16_t row) const {
    return level_[channel][row * columns_ + column];
  }
  /// Returns the levels of all channels, corrected for `change`, the change of light since the map was made, and for a
  /// further change of `brighter` levels. In YUV, the change of the first channel applies to all three.
  [[nodiscard]] std::array<std::uint8_t, 3> levels(const LightChange& change, std::uint16_t column, std::uint16_t row,
                                                   const std::array<float, 3>& brighter = {}) const;
  [[nodiscard]] std::uint16_t columns() const { return static_cast<std::uint16_t>(columns_); }
  [[nodiscard]] std::uint16_t rows() const { return static_cast<std::uint16_t>(rows_); }

 private:
  bool active_ = false;
  ColorSpace space_ = ColorSpace::kRgb;
  std::size_t columns_ = 0, rows_ = 0;
  std::array<std::array<std::uint8_t, kMaxTiles>, 3> level_{};
};

}  // namespace touchline
