#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/box_learning.h"

namespace touchline::calibrate {

/// A paint, and how far it would be from everything that is there, in levels of the channel that separates best, its
/// own spread (the usual one of the colors learned) taken off.
struct FreePaint {
  std::string name;
  int levels = 0;
};

/// Two colors that are too close, and what to do about it.
struct Exchange {
  std::size_t first = 0, second = 0;
  int levels = 0;             // between them
  std::size_t exchanged = 0;  // which of the two
  FreePaint instead;
};

struct ColorAdvice {
  std::vector<Exchange> exchanges;  // of the closest pairs, closest first; a color is exchanged once
  FreePaint freest;                 // of all paints, beside the colors that are there
};

/// Pairs less than `least_levels` apart, and for one of each the paint (usual_paints()) that would be farthest from all
/// other colors and the background in this camera's space under this light: paints are moved there by the gains that
/// bring the usual looks of the colors that are there to their learned ones. `shown_rgb`: medians of the colors.
ColorAdvice advise(const LearningInput& input, const LearningRules& rules, const std::vector<Channels>& shown_rgb,
                   const std::vector<PairMargin>& margins, int least_levels);

}  // namespace touchline::calibrate
