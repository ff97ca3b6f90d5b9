#pragma once

#include <cstddef>

#include "core/light/light_map.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::relight {

/// Draws Klancar fig. 8: the multiplicative component C/N of eq. (17), 1 / illumination, of one channel (0 red, 1
/// green, 2 blue) as a surface over the picture, seen from above its lower left corner. The plot has 900 x 640 pixels.
replay::SurfacePtr draw_component(const LightMap& map, std::size_t channel, std::size_t width_px,
                                  std::size_t height_px);

/// Draws contours of equal illumination (luminance, ITU-R BT.601) with their values over a picture of this size (figs.
/// 13 to 15). Values are multiples of a tenth of C. Lines are light on a dark background and dark on a light
/// background.
void draw_contours(cairo_t& context, const LightMap& map, std::size_t width_px, std::size_t height_px,
                   bool dark_background);

}  // namespace touchline::relight
