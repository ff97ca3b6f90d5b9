#pragma once

#include <cstddef>
#include <vector>

#include "tools/programs/calibrate/colors/box_learning.h"

namespace touchline::calibrate {

/// Boxes for the colors of one use, teams or the ball, in light that the pictures do not show: shade, brighter light,
/// another tint and glare. Robots and ball are found by these colors, while identification patches are looked at
/// wherever a team patch predicts them. The pixels of a color are computed in this light; boxes are made where they
/// are, most of them first, as long as a box contains no more of the background, things and other colors than `rules`
/// allow, is ten times more likely to show this color than another one that is found by its box, and (a team color)
/// twice as likely as an identification color, meets no box of another color in `known`, and contains no gray. A light
/// that is in a box of `known` needs no further one. At most kMaxColorBoxes together with `known`.
ColorBoxes light_boxes(const LearningInput& input, const LearningRules& rules, const ColorBoxes& known, ColorUse use);

}  // namespace touchline::calibrate
