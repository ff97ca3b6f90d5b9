#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/box_learning.h"

namespace touchline::calibrate {

double total(const std::vector<ColorCount>& pixels);
/// Returns the number of pixels whose value is in the box.
double count_in(const std::vector<ColorCount>& pixels, const ColorBox& box);
bool contains(const ColorBox& box, const Channels& value);
bool boxes_overlap(const ColorBox& a, const ColorBox& b);
/// Returns the quantile of one channel: the value below which the given share of the pixels lies; 255 without pixels.
std::uint8_t quantile(const std::vector<ColorCount>& pixels, std::size_t channel, double share);
/// Returns the box between the quantiles `tail` and 1 - `tail` of each channel.
ColorBox core_of(const std::vector<ColorCount>& pixels, ColorId color, double tail);

/// Sides of a box: channel * 2 + (0 low, 1 high).
constexpr std::size_t kSides = 6;
int side_value(const ColorBox& box, std::size_t side);
void set_side(ColorBox& box, std::size_t side, int value);

/// Computes the core boxes of all colors, at most kMaxColorBoxes. A color gets one box from the percentiles of each
/// channel, or several boxes where a single one would include other colors or the background: under varying light, the
/// pixels of a color form a slanted cloud.
ColorBoxes initial_boxes(const LearningInput& input, const LearningRules& rules);

}  // namespace touchline::calibrate
