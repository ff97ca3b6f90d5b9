#pragma once

#include <algorithm>

#include "core/marker/lanes.h"
#include "core/marker/outline_cover.h"

namespace touchline {
inline namespace TOUCHLINE_LANES {

/// How much of eight blurred pixels an outline covers, and how that changes when the outline moves.
struct Cover {
  Lanes value;           // 0 to 1
  Lanes by_x_m, by_y_m;  // derivative by the outline's center, zero where all or nothing is covered
};

/// What an edge leaves of pixels that lie beyond it.
struct EdgeRamp {
  Lanes value, slope;  // slope: derivative by the way inwards, not negative

  EdgeRamp(Lanes outside_m, float per_m) {
    const Lanes inside = all_lanes(0.5f) - all_lanes(per_m) * outside_m;
    value = between_0_and_1(inside);
    slope = keep((inside > all_lanes(0.0f)) & (inside < all_lanes(1.0f)), all_lanes(per_m));
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
    const Lanes sx = x * all_lanes(1.0f / half_length_m), sy = y * all_lanes(1.0f / half_width_m);
    const Lanes r = root(sx * sx + sy * sy), size = all_lanes(std::min(half_length_m, half_width_m));
    const EdgeRamp edge((r - all_lanes(1.0f)) * size, per_m);
    const Lanes slope = edge.slope * size / larger(r, all_lanes(1e-6f));
    return {edge.value, slope * sx * all_lanes(1.0f / half_length_m), slope * sy * all_lanes(1.0f / half_width_m)};
  }
};

// Tip forward, the origin in its centroid.
struct Triangle {
  float third_m;  // from the centroid to the base; twice that to the tip
  float nx, ny;   // across the edge on the left

  [[nodiscard]] Cover at(Lanes x, Lanes y, float per_m) const {
    const Lanes along = all_lanes(nx) * (x - all_lanes(2.0f * third_m)), across = all_lanes(ny) * y;
    const EdgeRamp base(all_lanes(-third_m) - x, per_m), left(along + across, per_m), right(along - across, per_m);
    const Lanes left_slope = left.slope * right.value, right_slope = left.value * right.slope;
    return {base.value * left.value * right.value,
            all_lanes(nx) * base.value * (left_slope + right_slope) - base.slope * left.value * right.value,
            all_lanes(ny) * base.value * (left_slope - right_slope)};
  }
};

/// Calls use(shape): shape.at(x, y, per_m) is what the outline covers of pixels (x, y) meters from its center along its
/// own axes.
template <class Use>
auto with_shape(const OutlineCover& cover, Use use) {
  const float half_length = cover.half_length_m(), half_width = cover.half_width_m();
  if (cover.outline() == PatchOutline::kCircle) return use(Ellipse{half_length, half_width});
  if (cover.outline() == PatchOutline::kTriangle) {
    return use(Triangle{2.0f / 3.0f * half_length, cover.across_left().x_m, cover.across_left().y_m});
  }
  return use(Rectangle{half_length, half_width});
}
inline Cover cover_at(const OutlineCover& cover, Lanes x_m, Lanes y_m, float ramp_m) {
  return with_shape(cover, [&](const auto& shape) { return shape.at(x_m, y_m, 1.0f / ramp_m); });
}

}  // namespace TOUCHLINE_LANES
}  // namespace touchline
