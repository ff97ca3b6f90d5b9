#include "core/marker/hypothesis_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr std::uint16_t kNone = 0xffff;
// Two poses that differ by less than these are equivalent for the controller.
constexpr float kNegligibleDistance_m = 0.01f, kNegligibleTurn_rad = 0.2f;

bool same_identity(const Hypothesis& a, const Hypothesis& b) {
  return a.team_patch == b.team_patch && a.robot == b.robot;
}

bool has_same_pose(const Hypothesis& a, const Hypothesis& b) {
  return a.team_patch == b.team_patch && distance_m(a.fit.pose.position, b.fit.pose.position) < kNegligibleDistance_m &&
         std::abs(wrap_angle(a.fit.pose.theta_rad - b.fit.pose.theta_rad)) < kNegligibleTurn_rad;
}

}  // namespace

// Two hypotheses conflict if they have the same team patch, share another patch, have the same name, or overlap.
void Selector::find_conflicts() {
  std::size_t end_of_patches = 0;
  for (const Hypothesis& h : hypotheses_) {
    for (const std::uint16_t patch : h.identification) {
      if (patch != kMissing) end_of_patches = std::max(end_of_patches, std::size_t{patch} + 1);
    }
  }
  std::fill_n(with_patch_.begin(), end_of_patches, Set());
  with_name_.fill({});
  near_.fill({});
  float largest_side = 0;
  for (const float side : robot_side_m_) largest_side = std::max(largest_side, side);
  // Width of the strips: positions closer than this are in the same strip or in adjacent ones. It is slightly larger
  // than needed, so that rounding has no effect.
  const float far = 1.01f * kMinRobotDistance * largest_side;
  const auto strip_of = [](float strips) {
    return static_cast<std::size_t>(static_cast<std::int64_t>(std::floor(strips)) & std::int64_t{kStrips - 1});
  };
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const Hypothesis& h = hypotheses_[i];
    conflicts_[i] = {};
    const Set known = same_patch_or_name(h);
    for (const std::uint16_t patch : h.identification) {
      if (patch != kMissing) with_patch_[patch].insert(i);
    }
    const std::size_t team = index_of(h.team);
    if (h.robot >= 0) with_name_[team][static_cast<std::size_t>(h.robot)].insert(i);
    const FieldPoint at = h.fit.pose.position;
    const std::array<std::size_t, 2> strip{strip_of(at.x_m / far), strip_of(at.y_m / far)};
    const Set near = near_[0][strip[0]].common(near_[1][strip[1]]).without(known);
    near.for_each_below(options_[h.team_patch].begin, [&](std::size_t j) {
      const float side = 0.5f * (robot_side_m_[team] + robot_side_m_[index_of(hypotheses_[j].team)]);
      if (distance_m(at, hypotheses_[j].fit.pose.position) >= kMinRobotDistance * side) return;
      conflicts_[i].insert(j);
      conflicts_[j].insert(i);
    });
    for (std::size_t axis = 0; axis < near_.size(); ++axis) {
      for (const std::size_t beside : {strip[axis] + kStrips - 1, strip[axis], strip[axis] + 1}) {
        near_[axis][beside % kStrips].insert(i);
      }
    }
  }
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const Hypothesis& h = hypotheses_[i];
    conflicts_[i].insert(same_patch_or_name(h));
    for (std::size_t j = options_[h.team_patch].begin; j < options_[h.team_patch].end; ++j) conflicts_[i].insert(j);
    conflicts_[i].remove(i);
  }
}

// Returns the earlier hypotheses that use an identification patch of this one, or have its name.
HypothesisSet Selector::same_patch_or_name(const Hypothesis& h) const {
  Set out;
  for (const std::uint16_t patch : h.identification) {
    if (patch != kMissing) out.insert(with_patch_[patch]);
  }
  if (h.robot >= 0) out.insert(with_name_[index_of(h.team)][static_cast<std::size_t>(h.robot)]);
  return out;
}

void Selector::form_groups(std::size_t team_patches) {
  std::iota(group_of_.begin(), group_of_.end(), std::uint16_t{0});
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    conflicts_[i].for_each_below(options_[hypotheses_[i].team_patch].begin, [&](std::size_t j) {
      const std::uint16_t a = group_of_[hypotheses_[i].team_patch], b = group_of_[hypotheses_[j].team_patch];
      if (a == b) return;
      for (std::size_t p = 0; p < team_patches; ++p) {
        if (group_of_[p] == b) group_of_[p] = a;
      }
    });
  }
}

void Selector::search(const Group& group, std::size_t depth, const Set& excluded, float value) {
  if (stop_at_first_ && found_) return;
  if (nodes_left_-- <= 0) return;
  if (value + bound_[depth] <= best_value_) return;
  if (depth == group.size()) {
    best_value_ = value;
    best_ = path_;
    found_ = true;
    return;
  }
  const Options& options = options_[group[depth]];
  const std::size_t count = options.end - options.begin;
  const std::uint64_t all = (std::uint64_t{1} << count) - 1;
  for (std::uint64_t left = all & ~excluded.from(options.begin, count); left != 0; left &= left - 1) {
    const auto h = static_cast<std::uint16_t>(options.begin + std::countr_zero(left));
    path_[depth] = h;
    const float with = value + hypotheses_[h].value;
    if (with + bound_[depth + 1] > best_value_) {
      search(group, depth + 1, excluded.with(conflicts_[h]), with);
      if (stop_at_first_ && found_) return;
    } else {
      --nodes_left_;  // the node has no children
    }
  }
  path_[depth] = kNone;
  search(group, depth + 1, excluded, value);
}

// Returns true if there is a set without the excluded hypotheses whose value is above `value`.
bool Selector::alternative(const Group& group, const Set& excluded, float value) {
  stop_at_first_ = true;
  found_ = false;
  best_value_ = value;
  nodes_left_ = alternative_nodes_left_;
  search(group, 0, excluded, 0.0f);
  alternative_nodes_left_ = nodes_left_;
  stop_at_first_ = false;
  complete_ = complete_ && nodes_left_ > 0;
  return found_ || nodes_left_ <= 0;
}

void Selector::choose_within(const Group& group, Nodes& share, Selection& out) {
  bound_[group.size()] = 0;
  for (std::size_t d = group.size(); d-- > 0;) {
    const Options& options = options_[group[d]];
    bound_[d] = bound_[d + 1] + (options.begin < options.end ? hypotheses_[options.begin].value : 0.0f);
  }
  best_value_ = -1.0f;
  best_.fill(kNone);
  nodes_left_ = share.best;
  search(group, 0, Set(), 0.0f);
  share.best = std::max(nodes_left_, 0);
  const bool exact = nodes_left_ > 0;
  complete_ = complete_ && exact;
  const std::array<std::uint16_t, kMaxTeamPatches> chosen = best_;
  const float floor = best_value_ - kMinIdMargin;
  alternative_nodes_left_ = share.alternatives;
  for (std::size_t d = 0; d < group.size(); ++d) {
    if (chosen[d] == kNone) continue;
    const Hypothesis& mine = hypotheses_[chosen[d]];
    Set same_name, same_place;
    for (std::uint16_t h = options_[group[d]].begin; h < options_[group[d]].end; ++h) {
      if (same_identity(mine, hypotheses_[h])) same_name.insert(h);
      if (has_same_pose(mine, hypotheses_[h])) same_place.insert(h);
    }
    Chosen choice{chosen[d], false, false};
    choice.id_is_sure = exact && mine.robot >= 0 && !alternative(group, same_name, floor);
    choice.pose_is_sure = exact && !alternative(group, same_place, floor);
    out.push_back(choice);
  }
  share.alternatives = std::max(alternative_nodes_left_, 0);
}

bool Selector::select(std::span<const Hypothesis> hypotheses, std::size_t team_patches,
                      std::array<float, 2> robot_side_m, Selection& out) {
  out.clear();
  hypotheses_ = hypotheses;
  robot_side_m_ = robot_side_m;
  complete_ = true;
  options_.fill({});
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    Options& options = options_[hypotheses[i].team_patch];
    if (options.end == 0) options.begin = static_cast<std::uint16_t>(i);
    options.end = static_cast<std::uint16_t>(i + 1);
  }
  find_conflicts();
  form_groups(team_patches);
  // The label of a group is the number of one of its team patches.
  std::array<bool, kMaxTeamPatches> has_options{};
  for (std::size_t p = 0; p < team_patches; ++p) {
    if (options_[p].begin < options_[p].end) has_options[group_of_[p]] = true;
  }
  const auto groups = static_cast<std::size_t>(std::count(has_options.begin(), has_options.end(), true));
  WorkBudget<int> best(kMaxNodesForBest, groups), alternatives(kMaxNodesForAlternatives, groups);
  for (std::size_t label = 0; label < team_patches; ++label) {
    if (!has_options[label]) continue;
    Group group;
    for (std::size_t p = 0; p < team_patches; ++p) {
      if (group_of_[p] == label && options_[p].begin < options_[p].end) group.push_back(static_cast<std::uint16_t>(p));
    }
    Nodes share{best.take(), alternatives.take()};
    choose_within(group, share, out);
    best.give_back(share.best);
    alternatives.give_back(share.alternatives);
  }
  return complete_;
}

}  // namespace touchline
