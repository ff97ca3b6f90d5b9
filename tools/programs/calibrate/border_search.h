#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/status.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// A pixel of the field beside its border.
struct OutlinePixel {
  double u_px = 0, v_px = 0;
};

/// The line of points with u cos(angle) + v sin(angle) = distance.
struct HoughLine {
  double angle_rad = 0, distance_px = 0;
  std::size_t votes = 0;
};

/// Klancar section 6.2 step by step, from a picture to the corners of the field's border.

/// Step 1: the border is what is bright and goes around most of the picture. The pixels inside that touch it: one-pixel
/// lines along the border, and along the markings that are drawn from it. Empty when nothing bright goes around at
/// least a tenth of the picture. Brightness is the least of the three channels: white has much of each.
std::vector<OutlinePixel> border_outline(const hal::Picture& picture, int threshold);
/// Between the two classes of brightness that are furthest apart (Otsu, "A threshold selection method from gray-level
/// histograms", 1979).
int brightness_threshold(const hal::Picture& picture);

/// Step 2: Hough transform (Duda and Hart 1972), and in it the border's four sides: the line with most votes, its
/// opposite, and the two across. In the order bottom, right, top, left. False: there are no four such lines.
bool hough_sides(const std::vector<OutlinePixel>& outline, int width_px, int height_px,
                 std::array<HoughLine, 4>& sides);

/// Step 3: H of eq. (12) for which three points of a side, near its ends and in its middle, lie on one line. A lens
/// without distortion, or with the other sign, gives kLargestH_px.
double h_of_three_points(const std::vector<OutlinePixel>& outline, const HoughLine& side, int width_px, int height_px);
inline constexpr double kLargestH_px = 1e5;

/// Steps 4 and 5, p, q and the rotation, are paper_steps()'s: from the sides once they are straight.
struct BorderSearch {
  int threshold = 0;
  std::vector<OutlinePixel> outline;
  std::array<HoughLine, 4> sides;
  double h_px = 0;  // the second smallest of the four sides'
  Corners corners;  // of the field, in fit_field()'s order, x to the right in the picture
  // Both once eq. (12) has straightened the picture; the sides in their order above.
  std::array<HoughLine, 4> straight_sides;
  Corners straight_corners;
};

/// All steps. kNotFound, with the reason.
Status find_border(const hal::Picture& picture, BorderSearch& out, std::string& reason);

}  // namespace touchline::calibrate
