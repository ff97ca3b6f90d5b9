#pragma once

#include <vector>

#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// A pixel of the field next to its border.
struct OutlinePixel {
  double u_px = 0, v_px = 0;
};

/// Step 1: finds a bright region that surrounds most of the picture, the border, and returns the pixels inside that
/// touch it: one-pixel lines along the border and along the markings that are connected to it. Empty if no bright
/// region surrounds at least a tenth of the picture. Brightness is the smallest of the three channels, because white is
/// bright in all of them.
std::vector<OutlinePixel> border_outline(const hal::Picture& picture, int threshold);
/// Returns the threshold between the two classes of brightness with the largest variance between them (Otsu, "A
/// threshold selection method from gray-level histograms", 1979).
int brightness_threshold(const hal::Picture& picture);

}  // namespace touchline::calibrate
