#pragma once

#include <algorithm>

#include "core/marker/lanes.h"
#include "core/marker/marker_layout.h"

namespace touchline {

/// How much of four blurred pixels an outline covers, and how that changes when the outline moves.
struct Cover {
  Lanes value{};             // 0 to 1
  Lanes by_x_m{}, by_y_m{};  // derivative by the outline's center, zero where all or nothing is covered
};

/// What an edge leaves of pixels that lie beyond it.
struct EdgeRamp {
  Lanes value, slope;  // slope: derivative by the way inwards, not negative

  EdgeRamp(Lanes outside_m, float per_m) {
    const Lanes inside = all_lanes(0.5f) - all_lanes(per_m) * outside_m;
    value = between_0_and_1(inside);
    slope = keep((inside > Lanes{}) & (inside < all_lanes(1.0f)), all_lanes(per_m));
  }
};

// Outlines in axes of their own, from their centers. `per_m`: 1 / width of a ramp.
struct Rectangle {
  float half_length_m, half_width_m;

  [[nodiscard]] Cover at(Lanes x, Lanes y, float per_m) const {
    const EdgeRamp along(absolute(x) - all_lanes(half_length_m), per_m);
    const EdgeRamp across(absolute(y) - all_lanes(half_width_m), per_m);
    return {along.value * across.value, with_sign(along.slope * across.value, sign_of(x)),
            with_sign(across.slope * along.value, sign_of(y))};
  }
};

// An ellipse is a circle in stretched axes; its edge's distance is right to first order.
struct Ellipse {
  float half_length_m, half_width_m;

  [[nodiscard]] Cover at(Lanes x, Lanes y, float per_m) const {
    const Lanes sx = x / all_lanes(half_length_m), sy = y / all_lanes(half_width_m);
    const Lanes r = root(sx * sx + sy * sy), size = all_lanes(std::min(half_length_m, half_width_m));
    const EdgeRamp edge((r - all_lanes(1.0f)) * size, per_m);
    const Lanes slope = edge.slope * size / larger(r, all_lanes(1e-6f));
    return {edge.value, slope * sx / all_lanes(half_length_m), slope * sy / all_lanes(half_width_m)};
  }
};

// Tip forward, the origin in its centroid.
struct Triangle {
  float third_m;  // from the centroid to the base; twice that to the tip
  float nx, ny;   // across the edge on the left

  [[nodiscard]] Cover at(Lanes x, Lanes y, float per_m) const {
    const Lanes along = all_lanes(nx) * (x - all_lanes(2.0f * third_m)), across = all_lanes(ny) * y;
    const EdgeRamp base(-x - all_lanes(third_m), per_m), left(along + across, per_m), right(along - across, per_m);
    const Lanes left_slope = left.slope * right.value, right_slope = left.value * right.slope;
    return {base.value * left.value * right.value,
            all_lanes(nx) * base.value * (left_slope + right_slope) - base.slope * left.value * right.value,
            all_lanes(ny) * base.value * (left_slope - right_slope)};
  }
};

/// A patch's outline as the picture shows it: its edges are not steps but ramps, because a pixel has an area, a lens
/// blurs, and two of three colors of a Bayer pixel are borrowed from its neighbors. A ramp of the right middle and any
/// width gives the right center, since what it gets wrong on one side it gets wrong on the other as well.
class OutlineCover {
 public:
  OutlineCover() = default;
  explicit OutlineCover(const PatchPlace& place);

  /// Of pixels (x, y) meters from the outline's center along its own axes; `ramp_m` is the width of an edge's ramp.
  [[nodiscard]] Cover at(Lanes x_m, Lanes y_m, float ramp_m) const;
  /// Calls use(shape), shape.at(x, y, per_m) being at() without the question which outline it is.
  template <class Use>
  auto with_shape(Use use) const {
    if (outline_ == PatchOutline::kCircle) return use(Ellipse{half_length_m_, half_width_m_});
    if (outline_ == PatchOutline::kTriangle) return use(Triangle{2.0f / 3.0f * half_length_m_, nx_, ny_});
    return use(Rectangle{half_length_m_, half_width_m_});
  }

  /// Cosine and sine of the angle from the robot's axes to the outline's own.
  [[nodiscard]] float cos() const { return cos_; }
  [[nodiscard]] float sin() const { return sin_; }
  /// Half of a box along its own axes, beyond which nothing is covered, or of a triangle's corners a tenth.
  [[nodiscard]] FieldPoint half_box(float ramp_m) const;
  /// The least width: with a ramp that is wider nothing would be covered fully.
  [[nodiscard]] float width_m() const { return width_m_; }

 private:
  PatchOutline outline_ = PatchOutline::kSquare;
  float half_length_m_ = 0, half_width_m_ = 0, reach_x_m_ = 0, width_m_ = 0;
  float cos_ = 1, sin_ = 0;  // of the outline's turn
  float nx_ = 0, ny_ = 0;    // of a triangle
};

}  // namespace touchline
