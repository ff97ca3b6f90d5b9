#pragma once

#include <array>

#include "hal/replay/picture.h"

namespace touchline::relight {

/// Changes of a picture that happen after calibration. They are applied in the order of the members; the defaults
/// change nothing.
struct PictureChange {
  double light = 1.0;                        // factor of the light everywhere, for a camera with a gamma of 2.2
  double shadow = 1.0;                       // factor of the light in the left half of the picture
  double blur_px = 0.0;                      // standard deviation of a Gaussian blur
  std::array<double, 3> values = {1, 1, 1};  // factors of the pixel values of red, green, blue
  int jpeg_quality = 0;  // 1 to 100 as in libjpeg, with half the columns and rows of color; 0: no compression

  [[nodiscard]] bool operator==(const PictureChange&) const = default;
};

/// Returns the changed 8-bit RGB picture. Values are rounded, and clipped to 0 to 255.
hal::Picture changed(const hal::Picture& picture, const PictureChange& change);

}  // namespace touchline::relight
