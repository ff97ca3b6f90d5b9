#pragma once

#include <array>

#include "core/color/color_tables.h"
#include "core/types.h"

namespace touchline {

/// Tracks how far each color's boxes must move in color space. If the tint of the lamps changes, paints move in ways
/// that a change of brightness does not explain.
class BoxShift {
 public:
  /// Sets the boxes and resets all shifts to 0. `max_levels` limits the shift of each channel. kOutOfRange:
  /// check(boxes) fails, or the limit is negative.
  Status configure(const ColorBoxes& boxes, float max_levels);
  void reset();

  /// Moves the shift of a color towards an observation, in which each channel was `deviation` levels above its expected
  /// value. `step`, 0 to 1, is the share of the difference that is applied. One observation moves the shift by at most
  /// kMaxStep_levels * step.
  void observe(ColorId color, const std::array<float, 3>& deviation, float step);

  /// Sets a shift that is known from another source than observations of the color. Observations add to it.
  void set_known(ColorId color, const std::array<float, 3>& levels) { known_[color] = levels; }

  /// Returns the sum of known and observed shift, within the limit.
  [[nodiscard]] std::array<float, 3> of(ColorId color) const;
  /// Returns the boxes, moved by whole levels. If boxes of two colors would overlap, both end halfway through the
  /// overlap. If one of them would become empty, both colors keep their calibrated boxes, and the other colors move.
  [[nodiscard]] ColorBoxes moved() const;

  static constexpr float kMaxStep_levels = 8.0f;

 private:
  using HeldColors = std::array<bool, kMaxColors + 1>;
  [[nodiscard]] ColorBoxes moved_except(const HeldColors& held) const;
  [[nodiscard]] bool separate_all(ColorBoxes& moved, HeldColors& held) const;

  ColorBoxes boxes_;
  float max_levels_ = 0;
  std::array<std::array<float, 3>, kMaxColors + 1> shift_{}, known_{};
};

}  // namespace touchline
