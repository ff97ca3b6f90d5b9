#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "tests/color/owned_picture.h"
#include "tests/color/rgb_to_yuv.h"
#include "tests/marker/painted_field.h"

// The colors of painted fields as a camera sees them.
namespace touchline::testing {

using Rgb = std::array<double, 3>;

inline constexpr Rgb kFloorRgb{40, 42, 40}, kOrangeRgb{220, 100, 30};

/// Returns the color of a patch, or of the floor, as the camera sees it.
inline Rgb painted_rgb(ColorId color) {
  switch (color) {
    case kBlue:
      return {50, 90, 200};
    case kYellow:
      return {200, 180, 30};
    case kOrange:
      return kOrangeRgb;
    case kRed:
      return {160, 50, 45};
    case kGreen:
      return {60, 130, 55};
    case kMagenta:
      return {150, 60, 140};
    case kCyan:
      return {70, 150, 160};
    case kViolet:
      return {110, 5, 190};
    case kPink:
      return {165, 52, 48};  // hardly different from red
    case kLime:
      return {120, 85, 50};
    default:
      return kFloorRgb;
  }
}

/// Rounds and clips a color to bytes; YUV is BT.601 in limited range.
inline Channels pixel_value(const Rgb& rgb, ColorSpace space) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.0, 255.0))); };
  const std::array<double, 3> value = in_space(space, rgb);
  return {byte(value[0]), byte(value[1]), byte(value[2])};
}

}  // namespace touchline::testing
