#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "core/marker/hypothesis.h"

namespace touchline {

/// A selected hypothesis and its certainty.
struct Chosen {
  std::uint16_t hypothesis = 0;
  bool id_is_sure = false;    // all explanations with another id, or without an id, are far less likely
  bool pose_is_sure = false;  // all explanations with another pose are far less likely
};

using Selection = FixedVector<Chosen, kMaxTeamPatches>;

/// A set of hypotheses by their numbers.
class HypothesisSet {
 public:
  void insert(std::size_t number) { words_[number / 64] |= std::uint64_t{1} << (number % 64); }
  void insert(const HypothesisSet& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
  }
  void remove(std::size_t number) { words_[number / 64] &= ~(std::uint64_t{1} << (number % 64)); }
  [[nodiscard]] HypothesisSet with(const HypothesisSet& other) const {
    HypothesisSet both = *this;
    both.insert(other);
    return both;
  }
  [[nodiscard]] HypothesisSet common(const HypothesisSet& other) const {
    HypothesisSet both = *this;
    for (std::size_t i = 0; i < words_.size(); ++i) both.words_[i] &= other.words_[i];
    return both;
  }
  [[nodiscard]] HypothesisSet without(const HypothesisSet& other) const {
    HypothesisSet rest = *this;
    for (std::size_t i = 0; i < words_.size(); ++i) rest.words_[i] &= ~other.words_[i];
    return rest;
  }
  /// Returns a mask; bit i is set if the set contains number `first` + i, for `count` numbers, at most 63.
  [[nodiscard]] std::uint64_t from(std::size_t first, std::size_t count) const {
    const std::size_t word = first / 64, shift = first % 64;
    std::uint64_t bits = words_[word] >> shift;
    if (shift != 0 && word + 1 < words_.size()) bits |= words_[word + 1] << (64 - shift);
    return bits & ((std::uint64_t{1} << count) - 1);
  }
  /// Calls `visit` with each number below `end`, in ascending order.
  template <class Visit>
  void for_each_below(std::size_t end, Visit visit) const {
    for (std::size_t i = 0; 64 * i < end; ++i) {
      for (std::uint64_t word = words_[i]; word != 0; word &= word - 1) {
        const std::size_t number = 64 * i + static_cast<std::size_t>(std::countr_zero(word));
        if (number >= end) return;
        visit(number);
      }
    }
  }

 private:
  std::array<std::uint64_t, kMaxHypotheses / 64> words_{};
};

/// Selects the most likely set of hypotheses in which no patch is used twice, no robot occurs twice, and no two robots
/// overlap.
///
/// Hypotheses that conflict form groups; each group is solved exactly by branch and bound. A pair without conflicts
/// (the only entry in its row and column of the paper's table) is a group of its own. If the paper's row, column and
/// left-over rules give pairs for all robots of a group, no other set has as many pairs, so the search finds them, too.
/// The search is bounded (work_budget.h). If it reaches the bound, no result of the group is certain.
class Selector {
 public:
  /// `robot_side_m` is indexed by Team. Hypotheses of one team patch, at most 63, must be adjacent. Returns false if
  /// the search reached a bound.
  bool select(std::span<const Hypothesis> hypotheses, std::size_t team_patches, std::array<float, 2> robot_side_m,
              Selection& out);

 private:
  using Set = HypothesisSet;
  struct Options {
    std::uint16_t begin = 0, end = 0;  // range of the hypotheses of a team patch, best first
  };
  using Group = FixedVector<std::uint16_t, kMaxTeamPatches>;  // numbers of team patches

  // The field is divided into strips along both axes. Their numbers are modulo kStrips.
  static constexpr std::size_t kStrips = 32;
  using Strips = std::array<Set, kStrips>;

  void find_conflicts();
  [[nodiscard]] Set same_patch_or_name(const Hypothesis& h) const;
  void form_groups(std::size_t team_patches);
  // Numbers of nodes of the search trees that may still be visited.
  struct Nodes {
    int best = 0, alternatives = 0;
  };

  // `share` is the number of nodes that may be visited; the function replaces it by the number of nodes that are left.
  void choose_within(const Group& group, Nodes& share, Selection& out);
  void search(const Group& group, std::size_t depth, const Set& excluded, float value);
  bool alternative(const Group& group, const Set& excluded, float value);

  std::span<const Hypothesis> hypotheses_;
  std::array<float, 2> robot_side_m_{};
  std::array<Set, kMaxHypotheses> conflicts_;
  // State of find_conflicts(): hypotheses that use a patch or have the name of a robot, and hypotheses with a position
  // in or beside a strip.
  std::array<Set, kMaxIdentification> with_patch_;
  std::array<std::array<Set, kMaxRobotsPerTeam>, 2> with_name_;
  std::array<Strips, 2> near_;  // strips along x and along y
  std::array<Options, kMaxTeamPatches> options_{};
  std::array<std::uint16_t, kMaxTeamPatches> group_of_{};
  // State of the search.
  std::array<float, kMaxTeamPatches + 1> bound_{};  // for each depth: largest value that the rest of the group can add
  std::array<std::uint16_t, kMaxTeamPatches> path_{}, best_{};
  float best_value_ = 0;
  bool stop_at_first_ = false, found_ = false, complete_ = true;
  int nodes_left_ = 0, alternative_nodes_left_ = 0;
};

}  // namespace touchline
