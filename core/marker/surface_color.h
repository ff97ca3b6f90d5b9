#pragma once

#include <algorithm>
#include <array>

#include "core/types.h"

namespace touchline {

/// Values from this one on count as saturated, unless a frame's values end below it (clipping_level.h).
constexpr int kSaturatedValue = 250;

/// Color of a surface as R, G, B above black, from nine pixels. YUV is converted (ITU-R BT.601).
struct SurfaceColor {
  std::array<float, 3> rgb{};
  std::array<float, 3> spread{};  // error of the mean if the surface is not uniform, in levels
  std::array<bool, 3> saturated{};
  int saturated_from = kSaturatedValue;  // least value of a saturated channel in this frame

  [[nodiscard]] int saturated_channels() const { return int{saturated[0]} + int{saturated[1]} + int{saturated[2]}; }
};

/// Converts a pixel value of the color space to R, G, B above black.
inline std::array<float, 3> to_rgb(const std::array<float, 3>& value, ColorSpace space) {
  if (space == ColorSpace::kRgb) return value;
  const auto above_black = [&](std::size_t c) { return value[c] - static_cast<float>(black_value(space, c)); };
  std::array<float, 3> rgb = yuv_to_rgb(space).of(above_black(0), above_black(1), above_black(2));
  for (float& channel : rgb) channel = std::max(0.0f, channel / float{YuvToRgb::kOne});
  return rgb;
}

/// Samples the surface around a point: 3 x 3 pixels at a distance of `step_px` (at least 1), without the lowest and the
/// highest value of each channel. Returns false if they are not all in the picture.
bool sample_surface(const Frame& frame, PixelPoint center, int step_px, SurfaceColor& out,
                    int saturated_from = kSaturatedValue);

/// A patch measured from its pixels, independent of color boxes.
struct GrownPatch {
  PixelPoint center;
  float area_px = 0;
  float major_px2 = 0, minor_px2 = 0;  // variances along the principal axes
  float axis_rad = 0;                  // direction of the major axis, from u towards v
  float side_rad = 0;                  // direction of a square's sides, modulo pi / 2
  float squareness = 0;                // 1: a square; 0: a disk
};

/// Grows a patch from one of its points: all pixels that are connected with the point and hardly differ from its color,
/// at most `reach_px` away along rows and columns. The work is bounded: large patches are sampled on a grid of 47 x 47
/// points. Returns false if the point or a fifth of the area is outside the picture, or if there are fewer than nine
/// samples.
bool grow_patch(const Frame& frame, PixelPoint seed, float reach_px, GrownPatch& out);

}  // namespace touchline
