#pragma once

#include <array>
#include <cstddef>

#include "core/marker/surface_color.h"
#include "core/types.h"

namespace touchline {

/// Color of a patch up to a common factor, from the pixels at its border.
struct BorderColor {
  // Amount of each channel by which the patch is brighter than what surrounds it, in linear light (square of the value
  // above black), relative to the mean of the channels.
  std::array<float, 3> excess{};
  std::array<float, 3> error{};       // standard deviation of the excess' logarithm
  std::array<float, 3> background{};  // what surrounds the patch: square of the value above black
  std::size_t rays = 0;               // that have their border in front of darker surroundings
};

/// Half of the rays, and those to the free sides of a square that is merged with something else at its two other sides,
/// without the ones along the edge of the free part.
constexpr std::size_t kLeastBorderRays = 8, kRaysOfTwoSides = 5;

/// Finds the color of a patch whose pixels are saturated in some channels (the only ones that count of `surface`). A
/// pixel at the border is a mixture of the patch and what surrounds it, so that channels which are saturated on the
/// patch are seen in their ratio there. Sixteen rays from the center are followed to `reach_px`; their spread gives the
/// errors. False if fewer than `least_rays` of them have their border between `inner_px` and `reach_px`, in front of
/// darker surroundings.
bool sample_border(const Frame& frame, PixelPoint center, const SurfaceColor& surface, float inner_px, float reach_px,
                   BorderColor& out, std::size_t least_rays = kLeastBorderRays);

}  // namespace touchline
