#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/layout_sampling.h"

namespace touchline::calibrate {

/// Completes markers of which some identification patches were not found, because their edges are blurred or merge with
/// neighbors. The heading follows from the long axis of the team patch (both directions are tried) or from one
/// identification patch; the layout then predicts the places of the missing patches. The inner part of a place becomes
/// a patch (FoundPatch::sampled) if its color is even and differs from the floor. The new patches are added to
/// `patches`. The residual of a completed marker is above 1 m, so that markers found completely come first; clear
/// patches make it smaller.
std::vector<MarkerCandidate> complete_markers(std::vector<FoundPatch>& patches, const std::vector<std::size_t>& numbers,
                                              const LayoutView& view);

}  // namespace touchline::calibrate
