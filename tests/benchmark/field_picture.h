#pragma once

#include <cstdint>

#include "core/region/region_scanner.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {

struct FieldScene {
  PixelFormat format = PixelFormat::kRgb24;
  int width_px = 640, height_px = 480;
  double noise = 3.0;                   // standard deviation of each channel, in 8-bit steps
  double specks_per_megapixel = 600.0;  // single pixels of any color: reflections, dust, hot pixels
  // A real floor: standard deviation of its brightness in 8-bit steps, in patches of about 4, 16 and 64 pixels.
  double texture = 0.0;
  std::uint32_t seed = 1;
};

/// Paints a field seen from above, as in the paper: 2.2 m x 1.8 m fill the picture's height; dark robots of 75 mm with
/// two patches each, five per team, at random poses; an orange ball; lines; surroundings. Edges are anti-aliased. The
/// same scene gives the same bytes on every machine with IEEE 754 arithmetic.
OwnedPicture paint_field(const FieldScene& scene);

/// Returns scan parameters for this picture: 13 color classes, as many as in the paper, in the format's color space.
ScanParameters field_parameters(const FieldScene& scene);

}  // namespace touchline::testing
