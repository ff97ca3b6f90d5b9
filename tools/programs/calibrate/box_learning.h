#pragma once

#include <string>
#include <vector>

#include "core/color/color_tables.h"
#include "tools/programs/calibrate/channel_image.h"

namespace touchline::calibrate {

/// A value and how many pixels have it.
struct ColorCount {
  Channels value{};
  std::uint32_t count = 0;
};

/// Equal values put together, in ascending order.
std::vector<ColorCount> count_colors(const std::vector<Channels>& pixels);

struct ColorSamples {
  std::string name;
  std::vector<ColorCount> pixels;  // of the patches clicked on
};

struct LearningInput {
  ColorSpace space = ColorSpace::kRgb;
  std::vector<ColorSamples> colors;    // ColorId of colors[i] is i + 1
  std::vector<ColorCount> background;  // pixels away from all patches
};

// How the boxes are cut. The defaults are meant for every camera; tests hold them on synthetic pictures.
struct LearningRules {
  double core_tail = 0.002;        // of a color's pixels, each side of each channel: less than any one patch of it
  int max_margin = 40;             // levels beyond the core where nothing is in the way: unseen shading
  double background_share = 2e-5;  // of the background that a box may catch while it grows: single noisy pixels
  double other_share = 2e-3;       // of another color's pixels, likewise
  double carve_share = 1e-4;       // of the background that a core may hold before it is shrunk
  double most_carved = 0.4;        // of a box's own pixels that may go for it: a patch keeps its middle
  std::size_t boxes_a_color = 4;
};

/// Two colors, and the smallest distance in levels between their cores in the channel that separates them best;
/// negative: the cores overlap, and pixels of one will be taken for the other.
struct PairMargin {
  std::size_t first = 0, second = 0;
  int levels = 0;
};

struct LearnedColors {
  ColorBoxes boxes;                 // no two of different colors have a common point
  std::vector<PairMargin> margins;  // every pair of colors, smallest first
  std::vector<double> cut_share;    // a color's own pixels that had to be given up to keep boxes apart
};

/// Boxes from samples: a core (percentiles) a color; where a core holds pixels of another color or of the background,
/// the color is split into several boxes; cores that still overlap are cut where least is lost; then all boxes grow
/// together, level by level, until they meet a sample or each other, and keep half of the way to what they met.
/// kOutOfRange: no colors, more than kMaxColors; kNotFound: a color without pixels; kFull: more boxes than
/// kMaxColorBoxes; kInconsistent: two colors cannot be told apart at all. `reason` names the color.
Status learn_boxes(const LearningInput& input, const LearningRules& rules, LearnedColors& out, std::string& reason);

}  // namespace touchline::calibrate
