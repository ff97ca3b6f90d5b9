#pragma once

#include <array>
#include <bitset>
#include <span>

#include "core/marker/hypothesis.h"

namespace touchline {

/// A hypothesis that was chosen, and how sure that is.
struct Chosen {
  std::uint16_t hypothesis = 0;
  bool id_is_sure = false;    // every other explanation that names no or another robot is far less likely
  bool pose_is_sure = false;  // the same of explanations that put the robot elsewhere or turn it
};

constexpr std::size_t kMaxTeamPatches = 64;
using Selection = FixedVector<Chosen, kMaxTeamPatches>;

/// Chooses the most likely set of hypotheses in which no patch is used twice, no robot named twice, and no two robots
/// stand in one place.
///
/// Uncontested pairs (one entry in the row and in the column of the paper's table) are settled at once. What is left
/// falls into groups that contest the same patches; each is solved exactly by branch and bound. Where the paper's row,
/// column and left-over rules lead to pairs for all robots of a group, there is no other set of so many pairs, and the
/// result is theirs. The search is bounded; where the bound is reached, nothing counts as sure.
class Selector {
 public:
  /// `robot_side_m` by Team. Hypotheses of one team patch stand together. True: nothing was cut short.
  bool select(std::span<const Hypothesis> hypotheses, std::size_t team_patches, std::array<float, 2> robot_side_m,
              Selection& out);

 private:
  using Set = std::bitset<kMaxHypotheses>;
  struct Options {
    std::uint16_t begin = 0, end = 0;  // hypotheses of a team patch, best first
  };
  using Group = FixedVector<std::uint16_t, kMaxTeamPatches>;  // team patches

  void find_conflicts();
  [[nodiscard]] bool conflict(const Hypothesis& a, const Hypothesis& b) const;
  void form_groups(std::size_t team_patches);
  void choose_within(const Group& group, Selection& out);
  void search(const Group& group, std::size_t depth, const Set& excluded, float value);
  bool alternative(const Group& group, const Set& excluded, float value);

  std::span<const Hypothesis> hypotheses_;
  std::array<float, 2> robot_side_m_{};
  std::array<Set, kMaxHypotheses> conflicts_;
  std::array<Options, kMaxTeamPatches> options_{};
  std::array<std::uint16_t, kMaxTeamPatches> group_of_{};
  // of the search
  std::array<float, kMaxTeamPatches + 1> bound_{};  // best that the rest of the group can add
  std::array<std::uint16_t, kMaxTeamPatches> path_{}, best_{};
  float best_value_ = 0;
  bool stop_at_first_ = false, found_ = false, complete_ = true;
  int nodes_left_ = 0, doubt_nodes_left_ = 0;
};

}  // namespace touchline
