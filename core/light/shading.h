#pragma once

#include <array>
#include <cstdint>

#include "core/light/light_map.h"
#include "core/types.h"

namespace touchline {

// A gain holds for a tile: constant inside it, so that kernels change tables between tiles and never between pixels.
constexpr std::uint16_t kTileWidth = 16, kTileHeight = 8;
constexpr std::size_t kMaxTiles =
    ((kMaxFrameWidth + kTileWidth - 1) / kTileWidth) * ((kMaxFrameHeight + kTileHeight - 1) / kTileHeight);

// Gains are quantized to levels a 32nd of an octave apart (2.2 %, below the noise of a pixel): 64 is no change,
// the range is 1/4 to 4.
constexpr std::uint8_t kLightLevels = 128, kNeutralLevel = 64;

/// Gain of a level: 2^((level - 64) / 32).
float gain_of_level(std::uint8_t level);

/// What a channel's value becomes: round(value * gain) up to 255; chroma (U, V) is scaled about 128.
std::uint8_t corrected(std::uint8_t value, std::uint8_t level, bool is_chroma);

/// Eq. (17) as levels a tile: 1 / illumination at the tile's center, interpolated bilinearly between the map's cells.
class Shading {
 public:
  /// kOutOfRange: an illumination that is not positive, or a picture larger than the capacity.
  /// In YUV the luminance of the map (ITU-R BT.601 weights) gives all three channels one level.
  Status build(const LightMap& map, std::uint16_t width_px, std::uint16_t height_px, ColorSpace space);
  void clear() { active_ = false; }

  [[nodiscard]] bool active() const { return active_; }
  /// Level of channel 0, 1, 2 in tile (u / kTileWidth, v / kTileHeight).
  [[nodiscard]] std::uint8_t level(std::size_t channel, std::uint16_t column, std::uint16_t row) const {
    return level_[channel][row * columns_ + column];
  }

 private:
  bool active_ = false;
  std::size_t columns_ = 0;
  std::array<std::array<std::uint8_t, kMaxTiles>, 3> level_{};
};

}  // namespace touchline
