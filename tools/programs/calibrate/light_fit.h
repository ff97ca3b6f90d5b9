#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "core/status.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/border_light.h"

namespace touchline::calibrate {

/// What the reference pictures show.
enum class LightSurface : std::uint8_t {
  kGreyPaper,  // the field covered with paper: averaged
  kField,      // the empty field: lines, goals and logos are left out
  kMoving,     // a few dozen pictures of a game: what is there most of the time, then as kField
  kBorder,     // the white border around the field, on which the floor does not shine
};

struct LightFitInput {
  std::vector<hal::Picture> pictures;
  LightSurface surface = LightSurface::kGreyPaper;
  Polygon region_of_interest;
  std::vector<std::uint8_t> floor;  // pixels that can be floor, a byte each; empty: all
  std::vector<BorderPlace> border;  // of kBorder
  // C of an earlier fit of the same surface, with which colors were learned: the map then says how much more or less
  // light there is now. None: C is the surface's median.
  std::optional<std::array<double, 3>> normal;
};

/// Cells that touch each other and have the same fault; in pixels, ends included.
struct LightSpot {
  bool saturated = false;  // else dark
  std::size_t left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
  std::size_t cells = 0;
};

/// What a person must know of the reference pictures.
struct LightReport {
  std::array<double, 3> normal{};         // C of eq. (17), one a channel: the illumination there is 1
  std::array<double, 3> least{}, most{};  // of the map, inside the region of interest
  std::size_t known_cells = 0;            // measured; the others were filled
  std::size_t saturated_cells = 0;        // brighter than the sensor can tell: the map is too low there
  std::size_t dark_cells = 0;             // too dark for a ratio
  std::size_t clamped_cells = 0;          // darker than the largest gain (4) can correct, or brighter than twice C
  std::vector<LightSpot> spots;           // the saturated and the dark ones, largest first
};

/// Klancar section 6.3.1: the illumination plane of pictures of one uniform surface, robustly reduced to a coarse grid
/// (median of each cell: stains, seams and marks vanish), smoothed with a Gaussian of one cell, divided by its median
/// inside the region of interest (C of eq. 17), a channel at a time. From paper the pictures' mean; from the field,
/// whose floor has one color but for what plain_floor() and mend_floor() leave out, their median; of the
/// border what border_light() makes of it. Cells outside the
/// region take the value of the nearest inside. kInconsistent: pictures of different sizes; kOutOfRange: most of it
/// saturated or black, hardly any floor, most of it beyond
/// what a map can correct; kNotFound: fewer than three pictures with things that move.
Status fit_light(const LightFitInput& input, LightMap& out, LightReport& report, std::string& reason);

/// The map as a venue file keeps it: 16 bits a channel, 32768 is 1.
hal::Picture map_picture(const LightMap& map);

}  // namespace touchline::calibrate
