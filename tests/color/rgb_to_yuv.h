#pragma once

#include <array>

#include "core/color_space.h"

namespace touchline::testing {

/// Returns the channels of a color in a color space, by the definition (ITU-R BT.601), not rounded. R, G, B are from 0
/// to 255.
inline std::array<double, 3> in_space(ColorSpace space, const std::array<double, 3>& rgb) {
  if (space == ColorSpace::kRgb) return rgb;
  const double luma = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
  const double u = (rgb[2] - luma) / 1.772, v = (rgb[0] - luma) / 1.402;
  if (space == ColorSpace::kYuvFullRange) return {luma, 128.0 + u, 128.0 + v};
  return {16.0 + luma * 219.0 / 255.0, 128.0 + u * 224.0 / 255.0, 128.0 + v * 224.0 / 255.0};
}

}  // namespace touchline::testing
