#pragma once

#include <cstdint>
#include <vector>

#include "hal/replay/picture.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// Part of the floor that shows something else than one plain surface.
struct PaperCheck {
  double other_share = 0;          // of the floor's pixels, in the worst picture
  std::size_t picture = 0;         // that picture
  std::size_t u_px = 0, v_px = 0;  // the first of those pixels in it
};

/// Compares each picture with what a field covered with grey paper looks like: a plain surface everywhere. Robots,
/// lines, goals and hands are not plain; the gradient of lamps and noise are. `floor`: 1 for each pixel that shows the
/// floor.
PaperCheck check_paper(const std::vector<hal::Picture>& pictures, const std::vector<std::uint8_t>& floor);

// Half of a robot: with the two pixels around it, one is 0.3 % of a field of 2.2 x 1.8 m in 640 x 480 pixels. Paper in
// the scenes of the tests has none, their empty fields have 3 to 8 % (lines), with ten robots 6 to 11 %.
inline constexpr double kMaxOtherShare = 0.0015;

}  // namespace touchline::calibrate
