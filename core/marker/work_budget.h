#pragma once

#include <cstddef>

#include "core/types.h"

namespace touchline {

/// Divides the work of one search in a frame among its claimants, which come one after the other. Each may take an
/// equal share of what the claimants before it left, so clutter that comes first cannot use up the work of a robot that
/// comes later. Units that a claimant gives back go to those behind it. `Units`: int or float.
template <class Units>
class WorkBudget {
 public:
  constexpr WorkBudget(Units units, std::size_t claimants) : left_(units), waiting_(claimants) {}

  /// Takes the shares of the next `claimants` claimants together. Claimants beyond the announced number get nothing.
  [[nodiscard]] constexpr Units take(std::size_t claimants = 1) {
    if (claimants == 0 || waiting_ < claimants) return {};
    const Units share = left_ * static_cast<Units>(claimants) / static_cast<Units>(waiting_);
    waiting_ -= claimants;
    left_ -= share;
    return share;
  }
  /// Returns the rest of a share. `rest` is negative if the claimant used more than its share.
  constexpr void give_back(Units rest) { left_ += rest; }
  /// Returns the units that nobody has taken.
  [[nodiscard]] constexpr Units left() const { return left_; }

 private:
  Units left_;
  std::size_t waiting_;
};

// The work of a frame. Each search has its own units, because a common pool would let a search of exponential cost
// take all units that others leave: the slowest pictures would become slower.
//
// search                           unit                          claimants
// splitting touching patches       pair of touching patches      colors in the picture
// hypotheses                       test of a neighboring patch   team patches
// best sets of hypotheses          node of the search tree       groups of conflicting hypotheses
// alternatives to the best sets    node of the search tree       groups of conflicting hypotheses
// borders of saturated patches     patch                         robots, then pairs of robots

/// Enough for all patches of 22 robots, each touching another one. Teams with few patches get less (matcher.cpp).
constexpr float kMaxTouchingPairs = static_cast<float>(kMaxRobots * kMaxPatches) / 2;
/// A crowd of 22 robots with six patches, 5 pixels wide, needs 240,000 tests; five paper robots per team need 3,000.
constexpr int kMaxNeighborTests = 400000;
/// 22 robots with six patches in a crowd need 400 nodes for the best sets and 500 for the alternatives.
constexpr int kMaxNodesForBest = 2000, kMaxNodesForAlternatives = 3000;
/// Enough for two patches of 22 robots, and for some poses that turn out to be wrong.
constexpr int kMaxBorders = 64;

}  // namespace touchline
