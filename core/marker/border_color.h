#pragma once

#include <array>
#include <cstddef>

#include "core/marker/surface_color.h"
#include "core/types.h"

namespace touchline {

/// Color of a patch up to a common factor, from the pixels at its border.
struct BorderColor {
  // For each channel, brightness of the patch minus that of its surroundings, in linear light (square of the value
  // above black), relative to the mean of the channels.
  std::array<float, 3> excess{};
  std::array<float, 3> error{};       // standard deviation of the excess' logarithm
  std::array<float, 3> background{};  // color of the patch's surroundings: square of the value above black
  std::size_t rays = 0;               // number of rays with a border in front of darker surroundings
};

/// Smallest number of rays that must find a border: half of all. For a square that is merged with another surface at
/// two sides, the rays to its free sides suffice, without those along the edge of the free part.
constexpr std::size_t kMinBorderRays = 8, kRaysOfTwoSides = 5;

/// Finds the color of a patch with saturated channels. `surface` tells which channels are saturated. A pixel at the
/// border is a mixture of the patch and its surroundings, so it shows the ratio of channels that are saturated on the
/// patch. Sixteen rays from the center are followed to `reach_px`; their spread gives the errors. Returns false if
/// fewer than `least_rays` of them have a border between `inner_px` and `reach_px` in front of darker surroundings.
bool sample_border(const Frame& frame, PixelPoint center, const SurfaceColor& surface, float inner_px, float reach_px,
                   BorderColor& out, std::size_t least_rays = kMinBorderRays);

}  // namespace touchline
