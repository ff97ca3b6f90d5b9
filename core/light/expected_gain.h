#pragma once

#include <array>
#include <cstdint>

#include "core/light/field_light.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// Light at a place of the picture relative to that of the typical colors, as far as it is known without any robot: the
/// light map, and the change of light that FieldLight measured. Refers to both, does not own them.
class ExpectedGain {
 public:
  /// Unknown everywhere.
  ExpectedGain() = default;
  ExpectedGain(const Shading& shading, const FieldLight& field) : shading_(&shading), field_(&field) {}

  [[nodiscard]] bool is_known() const { return field_ != nullptr && field_->active() && shading_->active(); }
  /// In levels (32 per octave); positive: brighter. The point must be in the picture, the light map active. In YUV the
  /// change of luma, for all channels.
  [[nodiscard]] float levels_at(std::size_t channel, const PixelPoint& at) const;
  /// Factors of R, G and B, also in YUV. Only valid if is_known(). The point must be in the picture.
  [[nodiscard]] std::array<float, 3> at(const PixelPoint& at) const;

 private:
  struct Tile {
    std::uint16_t column = 0, row = 0;
  };
  static Tile tile_of(const PixelPoint& at);
  // Of the light map alone.
  [[nodiscard]] float map_levels_at(std::size_t channel, const Tile& tile) const;

  const Shading* shading_ = nullptr;
  const FieldLight* field_ = nullptr;
};

}  // namespace touchline
