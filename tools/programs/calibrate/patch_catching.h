#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "tools/programs/calibrate/click_growth.h"
#include "tools/programs/calibrate/clicks.h"

namespace touchline::calibrate {

/// The patch that a person meant: around a click as of grow_patch(), no farther than the click's own radius if it has
/// one; in a rectangle the largest set of pixels of one color, those near the middle counting more, so that it may be
/// drawn inside of the patch or around it. kNotFound, with the reason: as grow_patch(); nothing of one color inside.
Status catch_patch(const ChannelImage& image, const std::vector<std::uint8_t>& inside, const Click& click,
                   GrowthLimits limits, GrownPatch& out, std::string& reason);

}  // namespace touchline::calibrate
