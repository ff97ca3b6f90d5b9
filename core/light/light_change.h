#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

// Light is counted in logarithms, 32 levels an octave: see light/shading.h.
constexpr float kLevelsAnOctave = 32.0f;

/// How the light has changed since the light map was made, as the picture's regions of known color tell it: a logarithm
/// a channel on a coarse grid that covers the picture. Kept as logarithms, in the levels of light/shading.h (32 an
/// octave).
class LightChange {
 public:
  static constexpr std::size_t kColumns = 5, kRows = 4;

  /// No change yet. `max_levels`: the change is held within plus and minus so many levels. kOutOfRange: an empty
  /// picture, or a bound that is not positive.
  Status configure(std::uint16_t width_px, std::uint16_t height_px, float max_levels);
  void reset();

  /// At `where` each channel is `levels` brighter than the light map says. `weight`, 0 to 1 a channel: how much a
  /// channel tells (a red patch says nothing about blue light). `step`, 0 to 1: the share of the difference that is
  /// believed; a single observation moves nothing by more than kMaxStep_levels times it.
  void observe(const PixelPoint& where, const std::array<float, 3>& levels, const std::array<float, 3>& weight,
               float step);
  /// Lets what was observed spread to where nothing is: each node drifts by `step`, 0 to 1, times kSpread towards its
  /// neighbors, and times kCommon towards the other channels.
  void relax(float step);

  /// In levels, positive: brighter than the light map says.
  [[nodiscard]] float at(std::size_t channel, const PixelPoint& where) const;
  /// Mean of all nodes and channels, in levels.
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
