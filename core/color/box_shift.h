#pragma once

#include <array>

#include "core/color/color_tables.h"
#include "core/types.h"

namespace touchline {

/// How far the colors' boxes have to move, each color by its own: what a change of the lamps' tint does to paints, and
/// light alone does not explain.
class BoxShift {
 public:
  /// No color is moved yet. `max_levels`: none is moved farther in any channel. kOutOfRange: check(boxes), or a
  /// negative bound.
  Status configure(const ColorBoxes& boxes, float max_levels);
  void reset();

  /// The color was seen `off` levels from where it is expected. `step`, 0 to 1: the share of the difference to the
  /// present shift that is believed; a single observation moves it by at most kMaxStep_levels times that.
  void observe(ColorId color, const std::array<float, 3>& off, float step);

  [[nodiscard]] const std::array<float, 3>& of(ColorId color) const { return shift_[color]; }
  /// The boxes, moved by whole levels. Where two colors would meet, both end halfway; if nothing would be left of one,
  /// all stay in their places.
  [[nodiscard]] ColorBoxes moved() const;

  static constexpr float kMaxStep_levels = 8.0f;

 private:
  ColorBoxes boxes_;
  float max_levels_ = 0;
  std::array<std::array<float, 3>, kMaxColors + 1> shift_{};
};

}  // namespace touchline
