#pragma once

#include <array>
#include <vector>

#include "tools/programs/calibrate/patch_search.h"

namespace touchline::calibrate {

/// Patches that lie as those of a robot's marker do, whatever their colors.
struct MarkerCandidate {
  std::size_t team = 0;  // whose layout, indexed by Team
  std::size_t picture = 0;
  std::vector<std::size_t> patches;  // in the layout's order: the team patch first
  double residual_m = 0;             // how far the patches are from their places, RMS
};

/// All ways in which the patches of one picture can be patches of a robot of `layout`: sizes and distances on the plane
/// of the patches, and the order in which they go around. `numbers`: indices that the patches have in what is returned.
std::vector<MarkerCandidate> find_markers(const std::vector<FoundPatch>& patches,
                                          const std::vector<std::size_t>& numbers, const MarkerLayout& layout,
                                          const CameraModel& camera);

}  // namespace touchline::calibrate
