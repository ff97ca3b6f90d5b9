#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/types.h"
#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// A region with all properties that the paper names, and its pixels in raster order.
struct ExpectedRegion {
  ColorId color = kBackground;
  std::vector<Pixel> pixels;
  double centroid_u = 0.0, centroid_v = 0.0;
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// Returns the regions that a scan must report: the regions of the literal algorithm that have at least the given area
/// and height, in raster order of their first pixel.
std::vector<ExpectedRegion> expected_regions(const ColorGrid& grid, std::uint32_t min_area_px = 1,
                                             std::uint32_t min_height_px = 1);

/// Returns the first difference as a sentence, or an empty text. It also checks the runs: raster order, maximal length,
/// each run in exactly one chain, chains in raster order.
std::string difference(const std::vector<ExpectedRegion>& expected, const Runs& runs, const Regions& regions);

/// Removes the shortest runs of a row until at most `limit` remain, with the length steps of RunWriter::cut(). `Run`
/// has members `begin` and `end`.
template <class Run>
std::vector<Run> longest_runs(std::vector<Run> runs, std::size_t limit) {
  for (const int length : {2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64}) {
    if (runs.size() <= limit) break;
    std::erase_if(runs, [&](const Run& run) { return run.end - run.begin <= length; });
  }
  if (runs.size() > limit) runs.erase(runs.begin() + static_cast<std::ptrdiff_t>(limit), runs.end());
  return runs;
}

/// A picture without the pixels that a scan does not read, and without the runs that RunLimiter drops, by a literal
/// implementation of both rules.
struct LimitedPicture {
  ColorGrid grid;
  std::size_t runs_dropped = 0;
};
LimitedPicture without_dropped_runs(const ColorGrid& grid, std::uint32_t min_area_px, std::uint32_t min_height_px);

/// The result that a scan must report even if it is kFull: the regions of the LimitedPicture (if there are too many,
/// the largest; of equal ones the first), and the numbers of dropped runs and regions.
struct ExpectedScan {
  std::vector<ExpectedRegion> regions;
  std::size_t runs_dropped = 0, regions_dropped = 0;
};
ExpectedScan expected_scan(const ColorGrid& grid, std::uint32_t min_area_px, std::uint32_t min_height_px = 1);
std::string difference(const ExpectedScan& expected, const Runs& runs, const Regions& regions);
std::string difference_from_limited(const ColorGrid& grid, std::uint32_t min_area_px, const Runs& runs,
                                    const Regions& regions, std::uint32_t min_height_px = 1);

std::size_t count_runs(const ColorGrid& grid);

}  // namespace touchline::testing
