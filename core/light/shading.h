#pragma once

#include <array>
#include <cstdint>

#include "core/light/light_change.h"
#include "core/light/light_map.h"
#include "core/types.h"

namespace touchline {

// A gain holds for a tile: constant inside it, so that kernels change tables between tiles and never between pixels.
// Even sizes: pixels that share a chroma sample share a tile.
constexpr std::uint16_t kTileWidth = 16, kTileHeight = 8;
constexpr std::size_t kMaxTiles =
    ((kMaxFrameWidth + kTileWidth - 1) / kTileWidth) * ((kMaxFrameHeight + kTileHeight - 1) / kTileHeight);

// Gains are quantized to levels a 32nd of an octave apart (2.2 %, below the noise of a pixel): 64 is no change,
// the range is 1/4 to 4.
constexpr std::uint8_t kLightLevels = 128, kNeutralLevel = 64;

/// Gain of a level: 2^((level - 64) / 32). Range of level: below kLightLevels.
float gain_of_level(std::uint8_t level);

/// The level whose gain is nearest to `gain` by ratio; gains beyond the range get the last level on their side.
/// Range of gain: above 0.
std::uint8_t level_of_gain(float gain);

/// What a channel shows where no light falls, and about which light scales it: R, G and B 0; luma 16 and chroma 128
/// (ITU-R BT.601, limited range, as cameras deliver it).
constexpr std::uint8_t black_value(ColorSpace space, std::size_t channel) {
  if (space == ColorSpace::kRgb) return 0;
  return channel == 0 ? 16 : 128;
}

/// The largest value that a camera delivers: what is brighter looks the same.
constexpr std::uint8_t kFullScale = 255;

/// What a channel's value becomes: round(black + (value - black) * gain), bounded to 0..255. Never decreases when value
/// grows.
std::uint8_t corrected(std::uint8_t value, std::uint8_t level, std::uint8_t black);

/// Eq. (17) as levels a tile: 1 / illumination at the tile's center, interpolated bilinearly between the map's cells
/// and constant beyond the outermost cell centers.
class Shading {
 public:
  /// A map without columns switches the correction off. In YUV the luminance of the map (ITU-R BT.601 weights) gives
  /// all three channels one level.
  /// kOutOfRange: an illumination that is not positive and finite, columns without rows, more cells than the capacity,
  /// or a picture that is empty or larger than the capacity. After an error the correction is off.
  Status build(const LightMap& map, std::uint16_t width_px, std::uint16_t height_px, ColorSpace space);
  void clear() { active_ = false; }
  [[nodiscard]] bool active() const { return active_; }
  /// Level of channel 0, 1, 2 in tile (u / kTileWidth, v / kTileHeight); only when active().
  [[nodiscard]] std::uint8_t level(std::size_t channel, std::uint16_t column, std::uint16_t row) const {
    return level_[channel][row * columns_ + column];
  }
  /// The same, corrected by what has changed since the map was made. In YUV the first channel's change holds for all
  /// three.
  [[nodiscard]] std::uint8_t level(const LightChange& change, std::size_t channel, std::uint16_t column,
                                   std::uint16_t row) const;
  [[nodiscard]] std::uint16_t columns() const { return static_cast<std::uint16_t>(columns_); }
  [[nodiscard]] std::uint16_t rows() const { return static_cast<std::uint16_t>(rows_); }

 private:
  bool active_ = false;
  ColorSpace space_ = ColorSpace::kRgb;
  std::size_t columns_ = 0, rows_ = 0;
  std::array<std::array<std::uint8_t, kMaxTiles>, 3> level_{};
};

}  // namespace touchline
