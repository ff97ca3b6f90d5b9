#pragma once

#include "hal/result.h"
#include "tools/programs/calibrate/colors/box_learning.h"

namespace touchline::calibrate {

/// Removes overlaps between boxes of different colors. The color with fewer pixels in the overlap gives it up; the rest
/// of its box is divided into several boxes, up to kMaxColorBoxes in total and rules.boxes_a_color per color.
/// kInconsistent, with both names: nothing would be left of one color.
Result<void> separate_boxes(const LearningInput& input, const LearningRules& rules, ColorBoxes& cores);

/// Shrinks boxes that contain much background, one side at a time, choosing the side that removes most background for
/// the fewest pixels of the color. A box loses at most rules.most_carved of its pixels; the report shows the remaining
/// background.
void carve_background(const LearningInput& input, const LearningRules& rules, ColorBoxes& cores);

}  // namespace touchline::calibrate
