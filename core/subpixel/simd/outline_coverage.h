// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

namespace touchline {
namespace TOUCHLINE_SIMD {

/// Fraction of eight blurred pixels that an outline covers, and the fraction's derivatives by the outline's position.
struct Coverage {
  Float8 value;           // 0 to 1
  Float8 by_x_m, by_y_m;  // derivatives by the outline's center; zero where the coverage is 0 or 1
  Float8 by_width;        // derivative by the logarithm of the ramp's width
};

/// Coverage by a half plane with a blurred edge: 3 t^2 - 2 t^3. This is close to an edge after a Gaussian blur and
/// integration over a pixel. A linear ramp would err by a tenth at its ends; where a color is measured at every second
/// pixel, these errors would not cancel.
struct EdgeRamp {
  Float8 value, slope;  // slope: derivative along the inward direction, not negative
  Float8 by_width;      // derivative by the logarithm of the ramp's width

  EdgeRamp(Float8 outside_m, float per_m) {
    const Float8 t = clamp_to_unit(broadcast(0.5f) - broadcast(per_m) * outside_m);
    value = t * t * (broadcast(3.0f) - broadcast(2.0f) * t);
    const Float8 steepness = broadcast(6.0f) * t * (broadcast(1.0f) - t);
    slope = broadcast(per_m) * steepness;
    by_width = steepness * (broadcast(0.5f) - t);
  }
};

// Outlines in their own axes, relative to their centers. `per_m` is 1 / (width of a ramp).
struct Rectangle {
  float half_length_m, half_width_m;

  [[nodiscard]] Coverage at(Float8 x, Float8 y, float per_m) const {
    const EdgeRamp along(abs(x) - broadcast(half_length_m), per_m);
    const EdgeRamp across(abs(y) - broadcast(half_width_m), per_m);
    return {along.value * across.value, with_sign(along.slope * across.value, sign_bit(x)),
            with_sign(across.slope * along.value, sign_bit(y)),
            along.by_width * across.value + along.value * across.by_width};
  }
};

// An ellipse is treated as a circle in stretched axes. The distance to its edge is correct to first order.
struct Ellipse {
  float half_length_m, half_width_m;

  [[nodiscard]] Coverage at(Float8 x, Float8 y, float per_m) const {
    const Float8 sx = x * broadcast(1.0f / half_length_m), sy = y * broadcast(1.0f / half_width_m);
    const Float8 r = sqrt(sx * sx + sy * sy), size = broadcast(std::min(half_length_m, half_width_m));
    const EdgeRamp edge((r - broadcast(1.0f)) * size, per_m);
    const Float8 slope = edge.slope * size / max(r, broadcast(1e-6f));
    return {edge.value, slope * sx * broadcast(1.0f / half_length_m), slope * sy * broadcast(1.0f / half_width_m),
            edge.by_width};
  }
};

// A triangle with its tip forward and the origin in its centroid.
struct Triangle {
  float third_m;  // distance from the centroid to the base; the tip is twice as far
  float nx, ny;   // outward normal of the left edge

  [[nodiscard]] Coverage at(Float8 x, Float8 y, float per_m) const {
    const Float8 along = broadcast(nx) * (x - broadcast(2.0f * third_m)), across = broadcast(ny) * y;
    const EdgeRamp base(broadcast(-third_m) - x, per_m), left(along + across, per_m), right(along - across, per_m);
    const Float8 left_slope = left.slope * right.value, right_slope = left.value * right.slope;
    return {base.value * left.value * right.value,
            broadcast(nx) * base.value * (left_slope + right_slope) - base.slope * left.value * right.value,
            broadcast(ny) * base.value * (left_slope - right_slope),
            base.by_width * left.value * right.value +
                base.value * (left.by_width * right.value + left.value * right.by_width)};
  }
};

/// Calls use(shape). shape.at(x, y, per_m) is the coverage of pixels at (x, y) meters from the outline's center along
/// its own axes.
template <class Use>
auto with_shape(const BlurredOutline& outline, Use use) {
  const float half_length = outline.half_length_m(), half_width = outline.half_width_m();
  if (outline.outline() == PatchOutline::kCircle) return use(Ellipse{half_length, half_width});
  if (outline.outline() == PatchOutline::kTriangle) {
    return use(Triangle{2.0f / 3.0f * half_length, outline.across_left().x_m, outline.across_left().y_m});
  }
  return use(Rectangle{half_length, half_width});
}
inline Coverage coverage_at(const BlurredOutline& outline, Float8 x_m, Float8 y_m, float ramp_m) {
  return with_shape(outline, [&](const auto& shape) { return shape.at(x_m, y_m, 1.0f / ramp_m); });
}

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
