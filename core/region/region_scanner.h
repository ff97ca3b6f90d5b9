#pragma once

#include "core/color/color_tables.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

// Chamfered corners and goal boxes of a real field need 12; the rest is for hands that draw.
constexpr std::size_t kMaxPolygonPoints = 32;
using Polygon = FixedVector<PixelPoint, kMaxPolygonPoints>;

struct ScanParameters {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  ColorBoxes boxes;                  // in the format's color space
  LightMap light;                    // columns 0: none
  Polygon region_of_interest;        // pixel centers inside count; fewer than 3 points: the whole picture
  std::uint32_t min_area_px = 1;     // smaller regions are dropped and their runs have color kBackground's chain
};

/// Classification and labeling in one scan of the frame (paper, sections 3.2 and 4.1), over runs instead of pixels:
/// union-find gives the paper's regions without copying, in a bounded time.
class RegionScanner {
 public:
  /// kOutOfRange, kInconsistent (boxes of another color overlap is not an error here: the loader reports it).
  Status configure(const ScanParameters& parameters);

  /// Regions in raster order of their first pixel, 4-neighborhood; runs of a region chained by Run::next in raster
  /// order. kUnsupported: frame of another format or size than configured. kFull: runs or regions did not fit; what is
  /// in `regions` is complete up to the row where the runs ended; the counters of FixedVector::overflow() say how many.
  Status scan(const Frame& frame, Runs& runs, Regions& regions);
};

}  // namespace touchline
