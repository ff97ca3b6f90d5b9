#pragma once

#include <string>
#include <vector>

#include "core/color/color_tables.h"
#include "hal/result.h"
#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::calibrate {

/// A color value and its number of pixels.
struct ColorCount {
  Channels value{};
  std::uint32_t count = 0;
};

/// Counts equal values; the result is in ascending order.
std::vector<ColorCount> count_colors(const std::vector<Channels>& pixels);

/// Use of a color. Robots are found by the color of their team, in any light. Identification patches are read wherever
/// a team patch predicts them, whether or not a box contains their color.
enum class ColorUse : std::uint8_t { kOther, kTeam, kIdentification, kBall };

struct ColorSamples {
  std::string name;
  std::vector<ColorCount> pixels;  // pixels of the patches
  ColorUse use = ColorUse::kOther;
};

struct LearningInput {
  ColorSpace space = ColorSpace::kRgb;
  std::vector<ColorSamples> colors;    // ColorId of colors[i] is i + 1
  std::vector<ColorCount> background;  // pixels away from all patches
  std::vector<ColorCount> things;      // objects that no box for other light may contain, but that are no background
  int brightest = 255;                 // brightest value in the pictures, R, G or B
};

// Parameters of box learning. The defaults are for all cameras; tests check them with synthetic pictures.
struct LearningRules {
  double core_tail = 0.002;        // share of a color's pixels cut off per side and channel; less than one patch
  int max_margin = 40;             // largest growth in levels, for shades that the samples lack
  double background_share = 2e-5;  // share of the background that a growing box may include (noise)
  double other_share = 2e-3;       // share of another color's pixels that a growing box may include
  double carve_share = 1e-4;       // share of the background that a core may contain without being shrunk
  double most_carved = 0.4;        // largest share of its own pixels that a shrunk box loses
  std::size_t boxes_a_color = 4;
};

/// Two colors and the distance in levels between their cores, in the channel that separates them best. If it is
/// negative, the cores overlap, and pixels of one color are mistaken for the other.
struct PairMargin {
  std::size_t first = 0, second = 0;
  int levels = 0;
};

struct LearnedColors {
  ColorBoxes boxes;                 // boxes of different colors do not overlap
  std::vector<PairMargin> margins;  // all pairs of colors, smallest margin first
  std::vector<double> cut_share;    // for each color, share of its own pixels lost to keep boxes separate
};

/// Learns color boxes from samples. Each color starts with a core box (percentiles). If the core contains pixels of
/// another color or of the background, the color is split into several boxes; cores that still overlap are cut where
/// the loss is least. Then all boxes grow together, level by level. A side that meets samples keeps half of the
/// distance to them. A side that meets another box or has the largest margin keeps so much distance from the background
/// that boxes can move in a game. Team colors get further boxes for other light (light_boxes()), and identification
/// colors make room for them. kOutOfRange: no colors, or more than kMaxColors. kNotFound: a color has no pixels. kFull:
/// there would be more boxes than kMaxColorBoxes. kInconsistent: two colors cannot be distinguished. The message names
/// the color.
Result<LearnedColors> learn_boxes(const LearningInput& input, const LearningRules& rules);

}  // namespace touchline::calibrate
