#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "hal/replay/picture.h"
#include "hal/result.h"
#include "tools/programs/calibrate/light/border_light.h"

namespace touchline::calibrate {

/// Surface that the reference pictures show.
enum class LightSurface : std::uint8_t {
  kGreyPaper,  // the field covered with grey paper; pictures are averaged
  kField,      // the empty field; lines, goals and logos are left out
  kMoving,     // a few dozen pictures of a game; the median removes moving objects, then as kField
  kBorder,     // the white border around the field, for a floor that reflects the lamps
};

struct LightFitInput {
  std::vector<hal::Picture> pictures;
  LightSurface surface = LightSurface::kGreyPaper;
  Polygon region_of_interest;
  std::vector<std::uint8_t> floor;  // 1 for each pixel that can show the floor; empty: all pixels
  std::vector<BorderPlace> border;  // needed for kBorder
  // C of the fit with which the colors were learned, from the same surface. With it, the map gives the light relative
  // to the time of that fit. Empty: C is the median of the surface.
  std::optional<std::array<double, 3>> normal;
};

/// Connected cells with the same defect. Pixel coordinates include both ends.
struct LightSpot {
  bool saturated = false;  // false: too dark
  std::size_t left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
  std::size_t cells = 0;
};

/// Quality of the reference pictures.
struct LightReport {
  std::array<double, 3> normal{};         // C of eq. (17) for each channel: the value at illumination 1
  std::array<double, 3> least{}, most{};  // range of the map inside the region of interest
  std::size_t known_cells = 0;            // cells that were measured; the others are filled from neighbors
  std::size_t saturated_cells = 0;        // cells in which the sensor is saturated, so the map is too low
  std::size_t dark_cells = 0;             // cells that are too dark for a ratio
  std::size_t clamped_cells = 0;          // cells darker than the largest gain (4) corrects, or brighter than 2 C
  std::vector<LightSpot> spots;           // saturated and dark spots, largest first
};

/// Measures the illumination map from pictures of one uniform surface (Klancar section 6.3.1). For each channel:
/// combines the pictures, takes the median of each cell of a coarse grid (which removes stains, seams and marks),
/// smooths with a Gaussian of one cell and divides by the median inside the region of interest (C of eq. 17). Pictures
/// of paper are averaged. For the field, the median of the pictures without the pixels that plain_floor() and
/// mend_floor() reject is used; for the border, the result of border_light(). Cells outside the region take the value
/// of the nearest cell inside. kInconsistent: pictures have different sizes. kOutOfRange: most of the surface is
/// saturated, black or beyond the range of a map, or hardly any floor is visible. kNotFound: fewer than three pictures
/// with moving objects.
Result<void> fit_light(const LightFitInput& input, LightMap& out, LightReport& report);

/// Returns the value of a channel, 0 to 255; `index` counts channels in raster order.
double channel_value(const hal::Picture& picture, std::size_t index);

/// Returns the map in the form of the map file: 16 bits per channel, 32768 is illumination 1.
hal::Picture map_picture(const LightMap& map);

}  // namespace touchline::calibrate
