#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/marker/simd4.h"

namespace touchline {

/// R, G, B above black for a group of eight pixels.
constexpr int kGroupSize = 8;
using PixelGroup = std::array<std::array<Simd4<float>, 2>, 3>;

/// Distinguishes the ball's color from others by its hue and by its difference from the floor. Under white light,
/// neither the lamps' reflection on the ball nor its dark side changes the hue.
class BallColor {
 public:
  using Rgb = std::array<float, 3>;

  /// Takes the colors of the ball and of the floor around it, as R, G, B above black.
  BallColor(const Rgb& ball, const Rgb& floor);

  [[nodiscard]] bool differs_from_floor() const;

  /// Returns a mask; bit i is set if pixel i has the ball's color.
  [[nodiscard]] std::uint32_t is_ball(const PixelGroup& rgb) const;
  /// Returns a mask; bit i is set if pixel i has a strong color that differs from the floor's. The ball's color counts
  /// as well.
  [[nodiscard]] std::uint32_t is_colorful(const PixelGroup& rgb) const;

 private:
  using ChannelVectors = std::array<Simd4<float>, 3>;

  Rgb ball_, floor_;
  // Each vector holds one value in all four lanes.
  ChannelVectors floor_chroma_, way_, hue_;
  Simd4<float> least_way_, white_factor_, least_along_, tolerance_, least_chroma2_;
};

}  // namespace touchline
