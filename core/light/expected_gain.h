#pragma once

#include <array>
#include <cstdint>

#include "core/light/field_light.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// Light at a place in the picture, relative to the light in which the typical colors were learned. It needs no robot:
/// it is the light map plus the change that FieldLight measured. Refers to both and owns neither.
class ExpectedGain {
 public:
  /// The light is unknown everywhere.
  ExpectedGain() = default;
  ExpectedGain(const Shading& shading, const FieldLight& field) : shading_(&shading), field_(&field) {}

  [[nodiscard]] bool is_known() const { return field_ != nullptr && field_->active() && shading_->active(); }
  /// Returns the light in levels (32 per octave); positive: brighter. The point must be in the picture, and the light
  /// map active. In YUV, all channels have the change of luma.
  [[nodiscard]] float levels_at(std::size_t channel, const PixelPoint& at) const;
  /// Returns factors of R, G and B, also in YUV. Only valid if is_known(). The point must be in the picture.
  [[nodiscard]] std::array<float, 3> at(const PixelPoint& at) const;

 private:
  struct Tile {
    std::uint16_t column = 0, row = 0;
  };
  static Tile tile_of(const PixelPoint& at);
  // Returns the levels of the light map alone.
  [[nodiscard]] float map_levels_at(std::size_t channel, const Tile& tile) const;

  const Shading* shading_ = nullptr;
  const FieldLight* field_ = nullptr;
};

}  // namespace touchline
