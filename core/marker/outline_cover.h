#pragma once

#include "core/marker/marker_layout.h"

namespace touchline {

/// How much of a blurred pixel an outline covers, and how that changes when the outline moves.
struct Cover {
  float value = 0;               // 0 to 1
  float by_x_m = 0, by_y_m = 0;  // derivative by the outline's center
};

/// A patch's outline as the picture shows it: its edges are not steps but ramps, because a pixel has an area, a lens
/// blurs, and two of three colors of a Bayer pixel are borrowed from its neighbors. A ramp of the right middle and any
/// width gives the right center, since what it gets wrong on one side it gets wrong on the other as well.
class OutlineCover {
 public:
  OutlineCover() = default;
  explicit OutlineCover(const PatchPlace& place);

  /// Of a pixel (x, y) meters from the outline's center, in the robot's frame; `ramp_m` is the width of an edge's ramp.
  [[nodiscard]] Cover at(float x_m, float y_m, float ramp_m) const;
  /// Nothing is covered farther from the center than this and half a ramp's diagonal.
  [[nodiscard]] float radius_m() const { return radius_m_; }
  /// The least width: with a ramp that is wider nothing would be covered fully.
  [[nodiscard]] float width_m() const { return width_m_; }

 private:
  PatchOutline outline_ = PatchOutline::kSquare;
  float half_length_m_ = 0, half_width_m_ = 0, radius_m_ = 0, width_m_ = 0;
  float cos_ = 1, sin_ = 0;  // of the outline's turn
};

}  // namespace touchline
