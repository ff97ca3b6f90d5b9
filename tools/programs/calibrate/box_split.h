#pragma once

#include <vector>

#include "tools/programs/calibrate/box_learning.h"

namespace touchline::calibrate {

double total(const std::vector<ColorCount>& pixels);
/// Pixels whose value lies in the box.
double count_in(const std::vector<ColorCount>& pixels, const ColorBox& box);
bool contains(const ColorBox& box, const Channels& value);
bool boxes_meet(const ColorBox& a, const ColorBox& b);
/// The box between the given quantile of each channel and its counterpart.
ColorBox core_of(const std::vector<ColorCount>& pixels, ColorId color, double tail);

/// Sides of a box: channel * 2 + (0 low, 1 high).
constexpr std::size_t kSides = 6;
int side_value(const ColorBox& box, std::size_t side);
void set_side(ColorBox& box, std::size_t side, int value);

/// The cores of all colors, at most kMaxColorBoxes: a box from the percentiles of each channel, and several where one
/// would hold other colors or the background (a color that runs through the light is a slanted cloud).
ColorBoxes core_boxes(const LearningInput& input, const LearningRules& rules);

}  // namespace touchline::calibrate
