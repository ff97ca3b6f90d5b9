#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "core/status.h"
#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// What a person must know of the reference pictures.
struct LightReport {
  std::array<double, 3> normal{};         // C of eq. (17), one a channel: the illumination there is 1
  std::array<double, 3> least{}, most{};  // of the map, inside the region of interest
  std::size_t saturated_cells = 0;        // brighter than the sensor can tell: the map is too low there
  std::size_t dark_cells = 0;             // too dark for a ratio
  std::size_t clamped_cells = 0;          // darker than the largest gain (4) can correct
};

/// Klancar section 6.3.1: the illumination plane of pictures of one uniform surface (the field covered with grey
/// paper), averaged, robustly reduced to a coarse grid (median of each cell: stains, seams and marks vanish), smoothed
/// with a Gaussian of one cell, divided by its median inside the region of interest (C of eq. 17), a channel at a time.
/// Cells outside the region take the value of the nearest inside. kInconsistent: pictures of different sizes, or not of
/// the given one; kOutOfRange: most of it saturated or black.
Status fit_light(const std::vector<hal::Picture>& pictures, const Polygon& region_of_interest, LightMap& out,
                 LightReport& report, std::string& reason);

/// The map as a venue file keeps it: 16 bits a channel, 32768 is 1.
hal::Picture map_picture(const LightMap& map);

}  // namespace touchline::calibrate
