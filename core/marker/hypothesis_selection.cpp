#include "core/marker/hypothesis_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr std::uint16_t kNone = 0xffff;
// Ten robots in one cluster need a few hundred nodes. The limits keep the worst picture below a few milliseconds.
constexpr int kNodesPerGroup = 5000;
constexpr int kNodesForAlternatives = 40000;
// Smaller differences of pose do not matter to the controller.
constexpr float kNegligibleDistance_m = 0.01f, kNegligibleTurn_rad = 0.2f;

bool share_a_patch(const Hypothesis& a, const Hypothesis& b) {
  for (const std::uint16_t i : a.identification) {
    if (i == kMissing) continue;
    if (std::find(b.identification.begin(), b.identification.end(), i) != b.identification.end()) return true;
  }
  return false;
}

bool same_identity(const Hypothesis& a, const Hypothesis& b) {
  return a.team_patch == b.team_patch && a.robot == b.robot;
}

bool has_same_pose(const Hypothesis& a, const Hypothesis& b) {
  return a.team_patch == b.team_patch && distance_m(a.fit.pose.position, b.fit.pose.position) < kNegligibleDistance_m &&
         std::abs(wrap_angle(a.fit.pose.theta_rad - b.fit.pose.theta_rad)) < kNegligibleTurn_rad;
}

}  // namespace

bool Selector::conflict(const Hypothesis& a, const Hypothesis& b) const {
  if (a.team_patch == b.team_patch || share_a_patch(a, b)) return true;
  if (a.team == b.team && a.robot >= 0 && a.robot == b.robot) return true;
  const float side =
      0.5f * (robot_side_m_[static_cast<std::size_t>(a.team)] + robot_side_m_[static_cast<std::size_t>(b.team)]);
  return distance_m(a.fit.pose.position, b.fit.pose.position) < kMinRobotDistance * side;
}

void Selector::find_conflicts() {
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) conflicts_[i].reset();
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!conflict(hypotheses_[i], hypotheses_[j])) continue;
      conflicts_[i][j] = true;
      conflicts_[j][i] = true;
    }
  }
}

void Selector::form_groups(std::size_t team_patches) {
  std::iota(group_of_.begin(), group_of_.end(), std::uint16_t{0});
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!conflicts_[i][j]) continue;
      const std::uint16_t a = group_of_[hypotheses_[i].team_patch], b = group_of_[hypotheses_[j].team_patch];
      if (a == b) continue;
      for (std::size_t p = 0; p < team_patches; ++p) {
        if (group_of_[p] == b) group_of_[p] = a;
      }
    }
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
  for (std::uint16_t h = options.begin; h < options.end; ++h) {
    if (excluded[h]) continue;
    path_[depth] = h;
    search(group, depth + 1, excluded | conflicts_[h], value + hypotheses_[h].value);
  }
  path_[depth] = kNone;
  search(group, depth + 1, excluded, value);
}

// True if there is a set without the excluded hypotheses whose value is above `value`.
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

void Selector::choose_within(const Group& group, Selection& out) {
  bound_[group.size()] = 0;
  for (std::size_t d = group.size(); d-- > 0;) {
    const Options& options = options_[group[d]];
    bound_[d] = bound_[d + 1] + (options.begin < options.end ? hypotheses_[options.begin].value : 0.0f);
  }
  best_value_ = -1.0f;
  best_.fill(kNone);
  nodes_left_ = kNodesPerGroup;
  search(group, 0, Set(), 0.0f);
  const bool exact = nodes_left_ > 0;
  complete_ = complete_ && exact;
  const std::array<std::uint16_t, kMaxTeamPatches> chosen = best_;
  const float floor = best_value_ - kDoubtfulMargin;
  for (std::size_t d = 0; d < group.size(); ++d) {
    if (chosen[d] == kNone) continue;
    const Hypothesis& mine = hypotheses_[chosen[d]];
    Set same_name, same_place;
    for (std::uint16_t h = options_[group[d]].begin; h < options_[group[d]].end; ++h) {
      same_name[h] = same_identity(mine, hypotheses_[h]);
      same_place[h] = has_same_pose(mine, hypotheses_[h]);
    }
    Chosen choice{chosen[d], false, false};
    choice.id_is_sure = exact && mine.robot >= 0 && !alternative(group, same_name, floor);
    choice.pose_is_sure = exact && !alternative(group, same_place, floor);
    out.push_back(choice);
  }
}

bool Selector::select(std::span<const Hypothesis> hypotheses, std::size_t team_patches,
                      std::array<float, 2> robot_side_m, Selection& out) {
  out.clear();
  hypotheses_ = hypotheses;
  robot_side_m_ = robot_side_m;
  alternative_nodes_left_ = kNodesForAlternatives;
  complete_ = true;
  options_.fill({});
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    Options& options = options_[hypotheses[i].team_patch];
    if (options.end == 0) options.begin = static_cast<std::uint16_t>(i);
    options.end = static_cast<std::uint16_t>(i + 1);
  }
  find_conflicts();
  form_groups(team_patches);
  for (std::size_t root = 0; root < team_patches; ++root) {
    Group group;
    for (std::size_t p = 0; p < team_patches; ++p) {
      if (group_of_[p] == root && options_[p].begin < options_[p].end) group.push_back(static_cast<std::uint16_t>(p));
    }
    if (!group.empty()) choose_within(group, out);
  }
  return complete_;
}

}  // namespace touchline
