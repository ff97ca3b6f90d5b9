#include "core/marker/neighbor_table.h"

#include <algorithm>
#include <cmath>

#include "core/marker/rigid_fit.h"

namespace touchline {

NeighborTable::NeighborTable(const TeamMarking& marking) : marking_(marking) {
  const auto place_of = [&](std::size_t patch) {
    return FieldPoint{marking.layout.patches[patch].x_m, marking.layout.patches[patch].y_m};
  };
  for (std::size_t s = 0; s + 1 < marking.layout.patches.size(); ++s) {
    window_[s] = window_of(marking.layout, s);
    for (std::size_t k = 0; k <= s; ++k) expected_m_[s + 1][k] = distance_m(place_of(k), place_of(s + 1));
  }
}

float NeighborTable::reach_m() const {
  float reach = 0;
  for (const DistanceWindow& window : window_) reach = std::max(reach, window.high_m);
  return reach;
}

void NeighborTable::compare(std::span<const Neighbor> neighbors, const PatchLists& patches, std::size_t team) {
  const std::size_t slots = marking_.layout.patches.size() - 1;
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    const PatchCandidate& patch = patches.identification[neighbors[i].number];
    const float distance = neighbors[i].distance_m;
    const auto bit = static_cast<NeighborSet>(1u << i);
    with_color_[patch.color] |= bit;
    for (std::size_t s = 0; s < slots; ++s) {
      const float error = distance - expected_m_[s + 1][0];
      value_of(from_team_patch_m2_[s], i) = error * error;
      if (distance <= window_[s].low_m || distance >= window_[s].high_m) continue;
      in_window_[s] |= bit;
      if (!patch.is_partly_visible && is_used_in_slot(s, patch.color)) of_any_robot_[s] |= bit;
    }
    for (std::size_t k = 0; k < i; ++k) {
      const PatchCandidate& other = patches.identification[neighbors[k].number];
      value_of(seen_m_[i], k) = value_of(seen_m_[k], i) = distance_m(other.at[team], patch.at[team]);
    }
  }
}

bool NeighborTable::is_used_in_slot(std::size_t slot, ColorId color) const {
  if (marking_.robots.empty()) return true;
  return std::any_of(marking_.robots.begin(), marking_.robots.end(),
                     [&](const RobotMarking& robot) { return robot.colors[slot] == color; });
}

}  // namespace touchline
