#pragma once

#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// A patch's outline as the picture shows it: its edges are not steps but ramps, because a pixel has an area, a lens
/// blurs, and two of three colors of a Bayer pixel are borrowed from its neighbors. A ramp of the right middle and any
/// width gives the right center, since what it gets wrong on one side it gets wrong on the other as well.
/// (core/subpixel/simd/outline_coverage.h says what of a pixel it covers.)
class BlurredOutline {
 public:
  BlurredOutline() = default;
  explicit BlurredOutline(const PatchPlace& place);

  [[nodiscard]] PatchOutline outline() const { return outline_; }
  [[nodiscard]] float half_length_m() const { return half_length_m_; }
  [[nodiscard]] float half_width_m() const { return half_width_m_; }
  /// Unit vector across a triangle's left edge, outwards.
  [[nodiscard]] FieldPoint across_left() const { return {nx_, ny_}; }
  /// Cosine and sine of the angle from the robot's axes to the outline's own.
  [[nodiscard]] float cos() const { return cos_; }
  [[nodiscard]] float sin() const { return sin_; }
  /// Half of a box along its own axes, beyond which nothing is covered, or of a triangle's corners a tenth. `ramp_m` is
  /// the width of an edge's ramp.
  [[nodiscard]] FieldPoint half_box(float ramp_m) const;
  /// Half of a box within which all is covered; not positive: there is none.
  [[nodiscard]] FieldPoint inner_box(float ramp_m) const;
  /// The least width: with a ramp that is wider nothing would be covered fully.
  [[nodiscard]] float width_m() const { return width_m_; }

 private:
  PatchOutline outline_ = PatchOutline::kSquare;
  float half_length_m_ = 0, half_width_m_ = 0, reach_x_m_ = 0, width_m_ = 0;
  float cos_ = 1, sin_ = 0;  // of the outline's turn
  float nx_ = 0, ny_ = 0;    // of a triangle
};

}  // namespace touchline
