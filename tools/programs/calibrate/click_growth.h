#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "tools/programs/calibrate/channel_image.h"

namespace touchline::calibrate {

struct GrowthLimits {
  int radius_px = 24;           // a patch reaches no farther from the click
  std::size_t min_area_px = 6;  // fewer pixels are an edge or noise
};

/// The patch around a click.
struct GrownPatch {
  std::vector<std::size_t> pixels;  // indices into ChannelImage::pixels
  double tolerance = 0;             // color distance at which it was cut from its surroundings
  double instability = 0;           // how much it depends on the tolerance: the smaller, the clearer its edge
};

/// Grows from the click over all tolerances at once and takes the region that changes least when the tolerance does
/// (the stability of Matas et al. 2002, with the distance to the click's color in place of the grey level): it ends at
/// the patch's edge without a threshold being chosen for a lamp. kNotFound, with the reason: outside the picture or the
/// region of interest, no stable patch, larger than the limits.
Status grow_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside, double u_px, double v_px,
                  const GrowthLimits& limits, GrownPatch& out, std::string& reason);

}  // namespace touchline::calibrate
