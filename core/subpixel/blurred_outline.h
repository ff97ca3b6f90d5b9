#pragma once

#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// A patch's outline as the picture shows it. Its edges are ramps, not steps: a pixel has an area, the lens blurs, and
/// two of three colors of a Bayer pixel are interpolated. A ramp of wrong width causes no bias of the center if its
/// middle is right, because errors on opposite sides cancel. core/subpixel/simd/outline_coverage.h computes the
/// fraction of a pixel that the outline covers.
class BlurredOutline {
 public:
  BlurredOutline() = default;
  explicit BlurredOutline(const PatchPlace& place);

  [[nodiscard]] PatchOutline outline() const { return outline_; }
  [[nodiscard]] float half_length_m() const { return half_length_m_; }
  [[nodiscard]] float half_width_m() const { return half_width_m_; }
  /// Outward unit normal of a triangle's left edge.
  [[nodiscard]] FieldPoint across_left() const { return {nx_, ny_}; }
  /// Cosine and sine of the angle from the robot's axes to the outline's axes.
  [[nodiscard]] float cos() const { return cos_; }
  [[nodiscard]] float sin() const { return sin_; }
  /// Half size of a box along the outline's axes. Beyond the box the coverage is zero (at a triangle's corners at most
  /// 0.1). `ramp_m` is the width of an edge's ramp.
  [[nodiscard]] FieldPoint half_box(float ramp_m) const;
  /// Half size of a box within which the coverage is 1. Not positive if there is none.
  [[nodiscard]] FieldPoint inner_box(float ramp_m) const;
  /// Smallest width of the outline. A wider ramp would cover no point completely.
  [[nodiscard]] float width_m() const { return width_m_; }
  /// Distance of a point from the outline along the outline's axes, positive inside. Near an ellipse to first order,
  /// near a corner the distance from the next edge's line.
  [[nodiscard]] float depth_m(FieldPoint point) const;

 private:
  PatchOutline outline_ = PatchOutline::kSquare;
  float half_length_m_ = 0, half_width_m_ = 0, reach_x_m_ = 0, width_m_ = 0;
  float cos_ = 1, sin_ = 0;  // of the outline's rotation
  float nx_ = 0, ny_ = 0;    // normal of a triangle's left edge
};

}  // namespace touchline
