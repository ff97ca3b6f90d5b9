#pragma once

#include <cstddef>
#include <vector>

#include "tools/programs/calibrate/colors/box_learning.h"

namespace touchline::calibrate {

/// Makes boxes for the colors of one use (teams or the ball) in light that the pictures do not show: shade, brighter
/// light, another tint, and glare. Robots and ball are found by these colors, whereas identification patches are read
/// wherever a team patch predicts them. The pixels of each color are computed for such light, and boxes are made where
/// most of them are. A box must contain no more of the background, of things and of other colors than `rules` allow,
/// overlap no box of another color in `known`, and contain no gray. A pixel in a box must have ten times the likelihood
/// under the box's own color than under any other color that is found by its box. For the box of a team color, it must
/// also have twice the likelihood than under any identification color. Light that a box of `known` covers needs no
/// further box. There are at most kMaxColorBoxes boxes together with `known`.
ColorBoxes light_boxes(const LearningInput& input, const LearningRules& rules, const ColorBoxes& known, ColorUse use);

}  // namespace touchline::calibrate
