#pragma once

#include <array>

#include "tools/programs/calibrate/light_grid.h"

namespace touchline::calibrate {

/// Which pixels are the plain floor: inside, and no more than noise and the change of light away from the usual color
/// around them; not within two pixels of others either (lines, goals, logos, robots and their blurred edges).
/// `background`: a plane a channel, values 0 to 255.
std::vector<std::uint8_t> plain_floor(const std::array<Plane, 3>& background, const std::vector<std::uint8_t>& inside,
                                      std::size_t width_px, std::size_t height_px);

/// Cells of a floor, reduced from plain_floor()'s pixels, that do not follow from those around them (what is left of a
/// line or a logo) become NaN; then gaps are filled from their surroundings, wider and wider.
void mend_floor(const LightGrid& grid, std::array<Plane, 3>& cells);

}  // namespace touchline::calibrate
