#pragma once

#include <array>

#include "tools/programs/calibrate/light/light_grid.h"

namespace touchline::calibrate {

/// Marks the pixels that show the plain floor. They lie inside the mask, differ from the local background by no more
/// than noise and the gradient of the light, and are more than two pixels away from pixels that differ more (lines,
/// goals, logos, robots and their blurred edges). `background`: one plane per channel, 0 to 255.
std::vector<std::uint8_t> plain_floor(const std::array<Plane, 3>& background, const std::vector<std::uint8_t>& inside,
                                      std::size_t width_px, std::size_t height_px);

/// Removes outliers from cells that were reduced from the pixels of plain_floor(): a cell that differs from its
/// neighbors (remains of a line or a logo) becomes NaN. Then fills the gaps from neighborhoods of increasing size.
void mend_floor(const LightGrid& grid, std::array<Plane, 3>& cells);

}  // namespace touchline::calibrate
