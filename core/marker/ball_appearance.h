#pragma once

#include <array>
#include <span>

#include "core/marker/robot_top.h"
#include "core/marker/surface_color.h"
#include "core/types.h"

namespace touchline {

/// Measurements of the pixels around a possible ball. Areas are shares from 0 to 1.
struct BallAppearance {
  PixelPoint center;   // center of the ball's pixels in the best disk; center of the disk if the ball is partly hidden
  float radius = 0;    // radius of the disk in pixels, less where pixels share chroma and the outline is less sharp
  float area_px = 0;   // area of the ball's color in the disk
  float visible = 0;   // share of the disk that is in the picture and on no robot
  float filled = 0;    // share of the visible disk that has the ball's color
  float overflow = 0;  // share of a ring around the disk that has the ball's color
  float colorful = 0;  // share of the wider surroundings with another strong color, as robots' patches have
  // Angular moments of the pixels of the ball's color, up to half a radius beyond the disk: 0 for a disk, at most 1.
  float elongation = 0;        // second moment: 0.38 for a rectangle of 3 : 2
  float squareness = 0;        // fourth moment: 0.43 for a square
  std::array<float, 3> rgb{};  // mean of the ball's color in the middle of the disk
};

/// Below this visible share, the mean of the ball's pixels is not its center.
constexpr float kWholeBall = 0.9f;

/// Smallest radius for look_at_ball(), in pixels. In a smaller ball, every pixel is mixed with the surroundings.
constexpr float kMinAppearanceRadius_px = 1.5f;

/// Fits a disk of the ball's size to the pixels around `seed`, a point of the ball, independently of the color boxes. A
/// pixel has the ball's color if its hue is that of `rgb` (R, G, B above black): neither the lamps' reflection on the
/// ball nor its dark side changes the hue under white light. It must also differ from the floor around the ball. The
/// work is bounded: at most 33 x 33 samples; on a large ball, only every second, third, ... pixel and row. Every second
/// sample is read first; the rest only where they show the ball's color. Returns false if the seed is outside the
/// picture, the radius is too small, the floor has nearly the ball's color, or hardly any sample has it.
bool look_at_ball(const Frame& frame, PixelPoint seed, float radius_px, const std::array<float, 3>& rgb,
                  std::span<const RobotTop> robots, BallAppearance& out);

}  // namespace touchline
