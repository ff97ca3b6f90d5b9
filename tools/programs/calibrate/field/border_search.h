#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/replay/picture.h"
#include "hal/result.h"
#include "tools/programs/calibrate/field/border_outline.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/calibrate/field/hough_sides.h"

namespace touchline::calibrate {

/// Finds the corners of the field's border in a picture with the steps of Klancar section 6.2; step 1 is in
/// border_outline.h, step 2 in hough_sides.h.

/// Step 3: returns H of eq. (12) for which three points of a side (near both ends and in the middle) lie on one line. A
/// lens without distortion, or with pincushion distortion, gives kLargestH_px.
double h_of_three_points(const std::vector<OutlinePixel>& outline, const HoughLine& side, int width_px, int height_px);
inline constexpr double kLargestH_px = 1e5;

/// Steps 4 and 5 (p, q and the rotation) are in vanishing_points.h; they use the straightened sides.
struct BorderSearch {
  int threshold = 0;
  std::vector<OutlinePixel> outline;
  std::array<HoughLine, 4> sides;
  double h_px = 0;  // second smallest value of the four sides
  Corners corners;  // corners of the field in the order of fit_field(), x to the right in the picture
  // Sides after straightening the picture with eq. (12), in the order of hough_sides().
  std::array<HoughLine, 4> straight_sides;
  Corners straight_corners;
};

/// Runs all steps. kNotFound: there is no border; the message says why.
Result<void> find_border(const hal::Picture& picture, BorderSearch& out);

}  // namespace touchline::calibrate
