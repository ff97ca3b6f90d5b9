#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/colors/region_growing.h"

namespace touchline::calibrate {

/// Selects the patch that a person marked. For a click, uses grow_region() with the radius of the click if it has one.
/// For a rectangle, takes the largest set of pixels of one color, with higher weight near the center, so that the
/// rectangle may be smaller or larger than the patch. kNotFound, with the reason: as for grow_region(), or the
/// rectangle contains no single color.
Result<GrownPatch> select_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside, const Click& click,
                                GrowthLimits limits);

}  // namespace touchline::calibrate
