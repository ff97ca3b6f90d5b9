#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::calibrate {

struct GrowthLimits {
  int radius_px = 24;           // largest distance from the click
  std::size_t min_area_px = 6;  // smaller regions are edges or noise
};

/// The region around a click.
struct GrownPatch {
  std::vector<std::size_t> pixels;  // indices into ChannelImage::pixels
  double tolerance = 0;             // color distance at which growth stopped
  double instability = 0;           // dependence of the area on the tolerance; small for a clear edge
};

/// Grows a region from the click for all tolerances and returns the most stable one, whose area changes least with the
/// tolerance. This is the stability of maximally stable extremal regions (Matas et al. 2002), with the distance to the
/// color of the click in place of the gray level. The region ends at the edge of the patch, and needs no threshold that
/// depends on the lamps. kNotFound, with the reason: outside the picture or the region of interest, no stable region,
/// or too large.
Result<GrownPatch> grow_region(const ChannelImage& image, const std::vector<std::uint8_t>& inside, double u_px,
                               double v_px, const GrowthLimits& limits);

}  // namespace touchline::calibrate
