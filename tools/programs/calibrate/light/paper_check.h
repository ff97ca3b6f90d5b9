#pragma once

#include <cstdint>
#include <vector>

#include "hal/replay/picture.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// Parts of the floor that do not show one plain surface.
struct PaperCheck {
  double other_share = 0;          // share of the floor's pixels, in the worst picture
  std::size_t picture = 0;         // index of the worst picture
  std::size_t u_px = 0, v_px = 0;  // first such pixel in it
};

/// Checks that each picture shows a plain surface everywhere, as a field covered with gray paper does. The gradient of
/// lamps and noise count as plain; robots, lines, goals and hands do not. `floor`: 1 for each pixel that shows the
/// floor.
PaperCheck check_paper(const std::vector<hal::Picture>& pictures, const std::vector<std::uint8_t>& floor);

// Largest share of other pixels, half a robot: with the two pixels around it, a robot is 0.3 % of a field of 2.2 x 1.8
// m in 640 x 480 pixels. In the scenes of the tests, paper has a share of 0, the empty fields 3 to 8 % (lines), fields
// with ten robots 6 to 11 %.
inline constexpr double kMaxOtherShare = 0.0015;

}  // namespace touchline::calibrate
