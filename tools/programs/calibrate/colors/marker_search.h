#pragma once

#include <array>
#include <vector>

#include "tools/programs/calibrate/colors/patch_search.h"

namespace touchline::calibrate {

// Position tolerance: centers of grown patches are a pixel off where colors of neighbors mix, and layouts are measured
// to 2 mm.
inline constexpr double kCenterError_px = 1.5, kLayoutError_m = 0.004;

/// Patches that are arranged like a robot's marker, whatever their colors.
struct MarkerCandidate {
  std::size_t team = 0;  // team whose layout fits, indexed by Team
  std::size_t picture = 0;
  std::vector<std::size_t> patches;  // patches in the order of the layout, the team patch first
  double residual_m = 0;             // RMS distance between patches and layout
};

/// Returns all combinations of patches of one picture that fit a robot with this `layout` by their sizes, their
/// distances in the plane of the patches, and their order around the robot. `numbers`: indices of the patches to use.
std::vector<MarkerCandidate> find_markers(const std::vector<FoundPatch>& patches,
                                          const std::vector<std::size_t>& numbers, const MarkerLayout& layout,
                                          const CameraModel& camera);

}  // namespace touchline::calibrate
