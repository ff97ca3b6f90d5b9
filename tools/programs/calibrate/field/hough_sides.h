#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tools/programs/calibrate/field/border_outline.h"

namespace touchline::calibrate {

/// The line u cos(angle) + v sin(angle) = distance.
struct HoughLine {
  double angle_rad = 0, distance_px = 0;
  std::size_t votes = 0;
};
/// Least number of votes for a side.
inline constexpr std::size_t kMinVotes = 60;

/// Step 2 of find_border(): Hough transform (Duda and Hart 1972). Finds the four sides of the border in the order
/// bottom, right, top, left: the line with most votes, the opposite line, and the two lines across. Returns false if
/// there are no four such lines.
bool hough_sides(const std::vector<OutlinePixel>& outline, int width_px, int height_px,
                 std::array<HoughLine, 4>& sides);

}  // namespace touchline::calibrate
