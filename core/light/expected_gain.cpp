#include "core/light/expected_gain.h"

#include <cmath>

namespace touchline {

float ExpectedGain::levels_at(std::size_t channel, const PixelPoint& at) const {
  const auto column = static_cast<std::uint16_t>(at.u_px / static_cast<float>(kTileWidth));
  const auto row = static_cast<std::uint16_t>(at.v_px / static_cast<float>(kTileHeight));
  return static_cast<float>(int{kNeutralLevel} - int{shading_->level(channel, column, row)}) +
         field_->at(channel, column, row);
}

std::array<float, 3> ExpectedGain::at(const PixelPoint& at) const {
  std::array<float, 3> gain{};
  for (std::size_t c = 0; c < gain.size(); ++c) gain[c] = std::exp2(levels_at(c, at) / kLevelsPerOctave);
  return gain;
}

}  // namespace touchline
