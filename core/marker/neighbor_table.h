#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/marker/hypothesis.h"
#include "core/marker/simd4.h"

namespace touchline {

// Within the window of a team patch there are at most the identification patches of four robots, two each, and noise.
constexpr std::size_t kMaxNeighbors = 16;

/// An identification patch near a team patch.
struct Neighbor {
  std::uint16_t number = 0;  // index in PatchLists::identification
  float distance_m = 0;      // distance from the team patch
  bool is_partly_visible = false;
};

/// A set of neighbors, with one bit for each.
using NeighborSet = std::uint16_t;
static_assert(kMaxNeighbors <= 16);

/// Caches properties of a team patch's neighbors for the search for hypotheses: which slots each may fill, and how well
/// the distances between them agree with the layout.
class NeighborTable {
 public:
  /// Marks a slot that no neighbor fills, in a list of neighbors by slot.
  static constexpr std::uint8_t kNone = 255;

  /// Makes the table for a team with at least one identification patch. The marking must outlive the table.
  explicit NeighborTable(const TeamMarking& marking);

  /// Returns the distances from the team patch that a slot's patch may have, and the largest distance of all slots.
  [[nodiscard]] const DistanceWindow& window(std::size_t slot) const { return window_[slot]; }
  [[nodiscard]] float reach_m() const;

  /// Takes the neighbors, at most kMaxNeighbors, in the order of their bits. Call it once.
  void compare(std::span<const Neighbor> neighbors, const PatchLists& patches, std::size_t team);

  /// Returns the neighbors that are at the right distance for a slot and have its color: the color of robot `robot`, or
  /// if this is negative, of any robot; then they must be completely visible, too.
  [[nodiscard]] NeighborSet candidates(std::size_t slot, int robot) const;

  /// Sum of the squared errors of a neighbor's distances from other patches, relative to the layout; indexed by
  /// neighbor.
  using Spreads = std::array<float, kMaxNeighbors>;
  /// Returns the neighbors of `candidates` that fit together with `set`, the patches of the slots before this one: each
  /// distance differs from the layout's by at most `gate_m`, and the spread is at most `most_m2`.
  [[nodiscard]] NeighborSet fitting(std::size_t slot, NeighborSet candidates, std::span<const std::uint8_t> set,
                                    float gate_m, float most_m2, Spreads& spreads_m2) const;

 private:
  [[nodiscard]] bool is_used_in_slot(std::size_t slot, ColorId color) const;

  // Holds values of all neighbors, four in each vector.
  static constexpr std::size_t kFours = kMaxNeighbors / 4;
  using Fours = std::array<Simd4<float>, kFours>;
  static float& value_of(Fours& values, std::size_t i) { return reinterpret_cast<float*>(values.data())[i]; }

  const TeamMarking& marking_;
  std::array<DistanceWindow, kMaxPatches> window_{};
  std::array<std::array<float, kMaxPatches>, kMaxPatches> expected_m_{};  // distances between patches of the layout
  std::array<Fours, kMaxNeighbors> seen_m_{};                             // distances between neighbors
  // For each slot: squared error of the distance from the team patch.
  std::array<Fours, kMaxPatches - 1> from_team_patch_m2_{};
  std::array<NeighborSet, kMaxColors + 1> with_color_{};
  std::array<NeighborSet, kMaxPatches - 1> in_window_{}, of_any_robot_{};  // for each slot
};

inline NeighborSet NeighborTable::candidates(std::size_t slot, int robot) const {
  if (robot < 0) return of_any_robot_[slot];
  const ColorId color = marking_.robots[static_cast<std::size_t>(robot)].colors[slot];
  return static_cast<NeighborSet>(in_window_[slot] & with_color_[color]);
}

inline NeighborSet NeighborTable::fitting(std::size_t slot, NeighborSet candidates, std::span<const std::uint8_t> set,
                                          float gate_m, float most_m2, Spreads& spreads_m2) const {
  // Process all groups of four, whether they have neighbors or not: processors would mispredict the branch of a loop
  // over their number.
  Fours spread = from_team_patch_m2_[slot];
  std::array<Simd4<std::int32_t>, kFours> is_within;
  is_within.fill(Simd4<std::int32_t>{-1, -1, -1, -1});
  for (std::size_t s = 0; s < set.size(); ++s) {
    if (set[s] == kNone) continue;
    const Fours& seen = seen_m_[set[s]];
    const float expected = expected_m_[slot + 1][s + 1];
    _Pragma("GCC unroll 4") for (std::size_t four = 0; four < kFours; ++four) {
      const Simd4<float> error = seen[four] - expected, square = error * error;
      is_within[four] &= square <= gate_m * gate_m;
      spread[four] += square;
    }
  }
  unsigned fit = 0;
  _Pragma("GCC unroll 4") for (std::size_t four = 0; four < kFours; ++four) {
    std::memcpy(&spreads_m2[4 * four], &spread[four], sizeof spread[four]);
    fit |= bits_of(is_within[four] & (spread[four] <= most_m2)) << 4 * four;
  }
  return static_cast<NeighborSet>(fit & candidates);
}

}  // namespace touchline
