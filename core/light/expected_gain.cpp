#include "core/light/expected_gain.h"

#include <cmath>

namespace touchline {

ExpectedGain::Tile ExpectedGain::tile_of(const PixelPoint& at) {
  return {static_cast<std::uint16_t>(at.u_px / static_cast<float>(kTileWidth)),
          static_cast<std::uint16_t>(at.v_px / static_cast<float>(kTileHeight))};
}

float ExpectedGain::map_levels_at(std::size_t channel, const Tile& tile) const {
  return static_cast<float>(int{kNeutralLevel} - int{shading_->level(channel, tile.column, tile.row)});
}

float ExpectedGain::levels_at(std::size_t channel, const PixelPoint& at) const {
  const Tile tile = tile_of(at);
  return map_levels_at(channel, tile) + field_->at(channel, tile.column, tile.row);
}

std::array<float, 3> ExpectedGain::at(const PixelPoint& at) const {
  const Tile tile = tile_of(at);
  std::array<float, 3> gain{};
  for (std::size_t c = 0; c < gain.size(); ++c) {
    const float levels = map_levels_at(c, tile) + field_->rgb_at(c, tile.column, tile.row);
    gain[c] = std::exp2(levels / kLevelsPerOctave);
  }
  return gain;
}

}  // namespace touchline
