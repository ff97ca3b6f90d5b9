#pragma once

#include <string>

#include "tools/programs/calibrate/box_learning.h"

namespace touchline::calibrate {

/// Takes from boxes of different colors what they have in common. The color that has fewer of its pixels there gives it
/// up; the rest of its box becomes several boxes, as long as there is room for them (kMaxColorBoxes,
/// rules.boxes_a_color). kInconsistent, with both names: nothing would be left of one.
Status part_cores(const LearningInput& input, const LearningRules& rules, ColorBoxes& cores, std::string& reason);

/// Shrinks boxes that hold much of the background, side by side, where most of it goes for the fewest pixels of the
/// color; at most rules.most_carved of a box's pixels. What then remains shows in the report.
void carve_background(const LearningInput& input, const LearningRules& rules, ColorBoxes& cores);

}  // namespace touchline::calibrate
