#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/box_learning.h"

namespace touchline::calibrate {

/// A paint and its distance from all colors in use, in levels of the channel that separates best, minus the usual
/// spread of a learned color.
struct PaintSuggestion {
  std::string name;
  int levels = 0;
};

/// Two colors that are too similar, and a replacement.
struct ColorReplacement {
  std::size_t first = 0, second = 0;
  int levels = 0;            // distance between the two colors
  std::size_t replaced = 0;  // index of the color to replace
  PaintSuggestion suggestion;
};

struct ColorAdvice {
  std::vector<ColorReplacement>
      replacements;            // for the closest pairs, closest first; each color is replaced at most once
  PaintSuggestion additional;  // best paint for one more color
};

/// Suggests replacements for pairs of colors less than `least_levels` apart. It suggests the paint (usual_paints())
/// that is farthest from all other colors and the background, in the color space of this camera and in this light. The
/// paints are converted by the gains that map the usual appearance of the known colors to the learned one. `shown_rgb`:
/// median RGB of the colors.
ColorAdvice advise(const LearningInput& input, const LearningRules& rules, const std::vector<Channels>& shown_rgb,
                   const std::vector<PairMargin>& margins, int least_levels);

}  // namespace touchline::calibrate
