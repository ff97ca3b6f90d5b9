#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/marker/simd4.h"

namespace touchline {

/// R, G, B above black for a group of eight pixels.
constexpr int kGroupSize = 8;
using PixelGroup = std::array<std::array<Simd4<float>, 2>, 3>;

/// Tells the ball's color from others by its hue, which neither the lamps' reflection on the ball nor its dark side
/// changes under white light, and by its difference from the floor.
class BallColor {
 public:
  using Rgb = std::array<float, 3>;

  /// Takes the colors of the ball and of the floor around it, as R, G, B above black.
  BallColor(const Rgb& ball, const Rgb& floor);

  [[nodiscard]] bool differs_from_floor() const;

  /// Bit i of the result: pixel i has the ball's color.
  [[nodiscard]] std::uint32_t is_ball(const PixelGroup& rgb) const;
  /// Bit i: pixel i has a strong color that differs from that of the floor. The ball's color counts as well.
  [[nodiscard]] std::uint32_t is_colorful(const PixelGroup& rgb) const;

 private:
  using ChannelVectors = std::array<Simd4<float>, 3>;

  Rgb ball_, floor_;
  // Each vector holds one value in all four lanes.
  ChannelVectors floor_chroma_, way_, hue_;
  Simd4<float> least_way_, white_factor_, least_along_, tolerance_, least_chroma2_;
};

}  // namespace touchline
