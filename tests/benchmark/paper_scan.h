#pragma once

#include <vector>

#include "core/region/region_scanner.h"
#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// The paper to the letter, as a measure for ours: three table look-ups and two ANDs a pixel (section 3.2), one-pass
/// labeling with lists of pixels, the smaller copied into the larger (section 4.1), and of each region color, count,
/// centroid and bounding box. Keeps its memory from one frame to the next.
class PaperScan {
 public:
  struct Found {
    ColorId color = kBackground;
    std::uint32_t area_px = 0;
    PixelPoint centroid;
    PixelBox box;
  };

  /// As RegionScanner::configure; light and region of interest must be absent.
  Status configure(const ScanParameters& parameters);

  /// In no particular order.
  const std::vector<Found>& scan(const Frame& frame);

 private:
  void classify_row(const Frame& frame, int v);

  ColorTables tables_;
  ColorGrid grid_;
  LiteralLabeling labeling_;
  std::vector<Found> found_;
};

}  // namespace touchline::testing
