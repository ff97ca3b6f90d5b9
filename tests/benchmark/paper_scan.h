#pragma once

#include <vector>

#include "core/region/region_scanner.h"
#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// The paper's algorithm, literally, as a baseline: three table look-ups and two ANDs per pixel (section 3.2), one-pass
/// labeling with lists of pixels, where the smaller list is copied into the larger one (section 4.1), and color, pixel
/// count, centroid and bounding box of each region. Memory is reused from frame to frame.
class PaperScan {
 public:
  struct Found {
    ColorId color = kBackground;
    std::uint32_t area_px = 0;
    PixelPoint centroid;
    PixelBox box;
  };

  /// As RegionScanner::configure(). kUnsupported: the parameters have a light map or a region of interest.
  Status configure(const ScanParameters& parameters);

  /// Returns the regions in no particular order, valid until the next call.
  const std::vector<Found>& scan(const Frame& frame);

 private:
  ColorTables tables_;
  ColorGrid grid_;
  LiteralLabeling labeling_;
  std::vector<Found> found_;
};

}  // namespace touchline::testing
