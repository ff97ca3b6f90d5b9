#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

// Light is counted on a logarithmic scale with 32 levels per octave; see light/shading.h.
constexpr float kLevelsPerOctave = 32.0f;

/// Estimates how the light has changed since the light map was made, from regions of known color. It holds one value
/// per channel on a coarse grid that covers the picture, in levels (logarithmic, 32 per octave).
class LightChange {
 public:
  static constexpr std::size_t kColumns = 5, kRows = 4;

  /// Sets the picture size and resets the change to 0. The change stays within -max_levels..max_levels. kOutOfRange:
  /// the picture is smaller than 2 x 2 pixels, or the limit is not positive.
  Status configure(std::uint16_t width_px, std::uint16_t height_px, float max_levels);
  void reset();

  /// Adds an observation: at `where`, each channel is `levels` brighter than in the light map. `weight`, 0 to 1:
  /// reliability of each channel (a red patch gives no information about blue light). `step`, 0 to 1: share of the
  /// difference that is applied. One observation changes a value by at most kMaxStep_levels * step.
  void observe(const PixelPoint& where, const std::array<float, 3>& levels, const std::array<float, 3>& weight,
               float step);
  /// Spreads observations to the rest of the picture: each node moves by step * kSpread, step from 0 to 1, towards the
  /// mean of its neighbors, and by step * kCommon towards the mean of all channels.
  void relax(float step);

  /// Returns the change at a point, in levels; positive: brighter than in the light map.
  [[nodiscard]] float at(std::size_t channel, const PixelPoint& where) const;
  /// Returns the change of all channels at a point.
  [[nodiscard]] std::array<float, 3> at(const PixelPoint& where) const;
  /// Returns the mean over all nodes and channels, in levels.
  [[nodiscard]] float mean() const;

  static constexpr float kMaxStep_levels = 8.0f;
  static constexpr float kSpread = 0.3f, kCommon = 0.05f;

 private:
  using Plane = std::array<float, kColumns * kRows>;
  struct Corner {
    std::size_t node = 0;
    float weight = 0;
  };
  [[nodiscard]] std::array<Corner, 4> around(const PixelPoint& where) const;
  static float value_at(const Plane& plane, const std::array<Corner, 4>& corners);

  float columns_per_px_ = 0, rows_per_px_ = 0, max_levels_ = 0;
  std::array<Plane, 3> levels_{};
};

}  // namespace touchline
