#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// A region with everything that the paper asks of it, its pixels in raster order.
struct ExpectedRegion {
  ColorId color = kBackground;
  std::vector<Pixel> pixels;
  double centroid_u = 0.0, centroid_v = 0.0;
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// What a scan must report of the picture: the literal algorithm's regions of at least that area, in raster order of
/// their first pixel.
std::vector<ExpectedRegion> expected_regions(const ColorGrid& grid, std::uint32_t min_area_px = 1);

/// The first difference, as a sentence; empty when there is none. Also looks at the runs themselves: in raster order,
/// maximal, each in exactly one chain, chains in raster order.
std::string difference(const std::vector<ExpectedRegion>& expected, const Runs& runs, const Regions& regions);

/// The same for a scan that was kFull: of more regions than fit only the largest (among equals the first ones); when
/// the runs ended the scan at some row, only regions that ended above it; and the counts of what is missing.
std::string difference_when_full(const ColorGrid& grid, std::uint32_t min_area_px, const Runs& runs,
                                 const Regions& regions);

/// Runs in the rows from first_row on.
std::size_t runs_from_row(const ColorGrid& grid, int first_row);

/// The row at which the scan ended for want of room, by the runs that it counted instead of keeping; the height when
/// it kept all, -1 when no row explains the count.
int row_of_end(const ColorGrid& grid, const Runs& runs);

}  // namespace touchline::testing
