#include "core/marker/hypothesis.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/marker/neighbor_table.h"

namespace touchline {
namespace {

// Gain in log likelihood per explained patch. It exceeds the cost of the worst fit within the gate, so more patches are
// always better, and a robot's own patches are better than those of another robot.
constexpr float kPatchReward = 60.0f;
// Gain of a complete set of a known robot compared with any other set of the same size.
constexpr float kIdentityReward = 10.0f;
// Cost of another team patch on the robot's top, which is impossible unless it is noise.
constexpr float kForeignPatchPenalty = 30.0f;
// Factor for a partly visible patch. An explanation with a complete patch always has a higher value.
constexpr float kPartlyVisibleReward = 0.5f;
// If the team patch is partly visible, a single identification patch must be complete, because its center gives the
// position.
constexpr float kCompletePatch = 0.6f;
// In bad light, only a sixth of an identification patch may be in its box. It is accepted as a dull patch unless a
// region of another color at this position has half its area.
constexpr float kMinDullRatio = 0.16f, kRivalArea = 0.5f;
// Error of a long team patch's axis: standard deviation 5 degrees if it is complete. Beyond 40 degrees the patch
// belongs to another robot.
constexpr float kAxisSigma = 0.1f, kAxisGate = 0.7f;
// Factor by which a bound is weakened to allow for rounding.
constexpr float kRounding = 1.01f;
// Work of evaluating a set of patches, in units of one test of a neighbor.
constexpr int kEvaluationWork = 30;
// Only the best hypotheses of a team patch can be selected.
constexpr std::size_t kMaxPerTeamPatch = 16;
static_assert(kMaxPerTeamPatch < 64);  // the selection keeps them in one word

float sigma_m(float scale_px_per_m) { return 0.001f + 0.2f / scale_px_per_m; }

FieldPoint place_of(const PatchPlace& place) { return {place.x_m, place.y_m}; }

// Searches the hypotheses of one team patch: depth-first over the slots of identification patches.
class Search {
 public:
  Search(const std::array<TeamMarking, 2>& teams, const PatchLists& patches, std::size_t index, int work)
      : patches_(patches),
        index_(index),
        patch_(patches.team[index].patch),
        team_(static_cast<std::size_t>(patches.team[index].team)),
        marking_(teams[team_]),
        others_(teams[1 - team_]),
        layout_(marking_.layout),
        slots_(layout_.patches.size() - 1),
        gate_m_(residual_gate_m(patch_.scale_px_per_m)),
        table_(marking_),
        work_left_(work) {
    set_.fill(kMissing);
    points_.push_back({place_of(layout_.patches[0]), patch_.at[team_]});
  }

  [[nodiscard]] int work_left() const { return work_left_; }
  bool run(Hypotheses& out) {
    find_neighbors();
    if (neighbors_.empty()) return true;
    table_.compare({neighbors_.data(), neighbors_.size()}, patches_, team_);
    find_rivals();
    for (std::size_t r = 0; r < marking_.robots.size(); ++r) {
      robot_ = static_cast<std::int8_t>(r);
      limit_spread();
      fill_slot(0);
    }
    robot_ = -1;
    // A partly visible team patch with an incomplete set is too little evidence.
    for (std::size_t missing = 0; missing < slots_ && !patch_.is_partly_visible; ++missing) {
      // More patches are always better.
      const float most = kPatchReward * static_cast<float>(slots_ - missing);
      if (found_.full() && most <= found_.back().value) break;
      missing_ = missing_left_ = missing;
      limit_spread();
      fill_slot(0);
    }
    for (const Hypothesis& h : found_) out.push_back(h);
    return complete_ && !exhausted_;
  }

 private:
  static bool better(const Neighbor& a, const Neighbor& b) {
    return a.is_partly_visible != b.is_partly_visible ? b.is_partly_visible : a.distance_m < b.distance_m;
  }

  void find_neighbors() {
    const float reach = table_.reach_m();
    for (std::size_t i = 0; i < patches_.identification.size(); ++i) {
      const float distance = distance_m(patch_.at[team_], patches_.identification[i].at[team_]);
      if (distance >= reach) continue;
      const bool partly_visible = patches_.identification[i].is_partly_visible;
      if (partly_visible && !helps_partly_visible(patches_.identification[i])) continue;
      const Neighbor neighbor{static_cast<std::uint16_t>(i), distance, partly_visible};
      if (neighbors_.full()) {
        const auto worst = std::max_element(neighbors_.begin(), neighbors_.end(), better);
        complete_ = complete_ && (partly_visible || worst->is_partly_visible);
        if (better(neighbor, *worst)) *worst = neighbor;
      } else {
        neighbors_.push_back(neighbor);
      }
    }
  }

  // Returns whether a dull patch can be used: a layout of three or more patches predicts its position from the others.
  bool helps_partly_visible(const PatchCandidate& patch) const {
    return slots_ > 1 && !patch_.is_partly_visible && patch.ratio >= kMinDullRatio;
  }

  // Fills the slots one after the other with every possible neighbor, but leaves `missing_left_` of them empty. For a
  // known robot (robot_ >= 0), all patches must be present. Incomplete sets, and sets whose colors belong to no robot,
  // are searched with robot_ < 0.
  void fill_slot(std::size_t slot) {
    if (work_left_ <= 0) exhausted_ = true;
    if (exhausted_) return;
    if (slot == slots_) {
      evaluate();
      return;
    }
    const bool may_be_filled = slot + missing_left_ < slots_;
    if (may_be_filled) work_left_ -= static_cast<int>(neighbors_.size());
    NeighborTable::Spreads added_m2;
    unsigned left = 0;
    if (may_be_filled) {
      const auto free = static_cast<NeighborSet>(table_.candidates(slot, robot_) & ~unsigned{used_});
      if (free != 0) {
        left = table_.fitting(slot, free, {of_slot_.data(), slot}, 2 * gate_m_, most_spread_m2_ - spread_m2_[slot],
                              added_m2);
      }
    }
    for (; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      spread_m2_[slot + 1] = spread_m2_[slot] + added_m2[i];
      if (spread_m2_[slot + 1] > most_spread_m2_) continue;  // the limit has fallen since
      set_[slot] = neighbors_[i].number;
      of_slot_[slot] = static_cast<std::uint8_t>(i);
      points_.push_back({place_of(layout_.patches[slot + 1]), patches_.identification[set_[slot]].at[team_]});
      used_ ^= static_cast<NeighborSet>(1u << i);
      dull_ += neighbors_[i].is_partly_visible ? 1 : 0;
      fill_slot(slot + 1);
      dull_ -= neighbors_[i].is_partly_visible ? 1 : 0;
      used_ ^= static_cast<NeighborSet>(1u << i);
      points_.pop_back();
      if (exhausted_) return;
    }
    set_[slot] = kMissing;
    of_slot_[slot] = NeighborTable::kNone;
    spread_m2_[slot + 1] = spread_m2_[slot];
    if (missing_left_ == 0) return;
    --missing_left_;
    fill_slot(slot + 1);
    ++missing_left_;
  }

  bool is_of_a_known_robot() const {
    return missing_ == 0 && std::any_of(marking_.robots.begin(), marking_.robots.end(), [&](const RobotMarking& robot) {
             for (std::size_t s = 0; s < slots_; ++s) {
               if (patches_.identification[set_[s]].color != robot.colors[s]) return false;
             }
             return true;
           });
  }

  void evaluate() {
    if (robot_ < 0 && is_of_a_known_robot()) return;
    work_left_ -= kEvaluationWork;
    if (points_.size() < 2) return;
    Hypothesis h;
    h.team_patch = static_cast<std::uint16_t>(index_);
    h.team = patches_.team[index_].team;
    h.robot = robot_;
    h.seen = static_cast<std::uint8_t>(points_.size() - 1);
    h.identification = set_;
    if (patch_.is_partly_visible) {
      evaluate_partly_visible(h, {points_.data() + 1, points_.size() - 1});
      return;
    }
    if (!fit_rigidly_within(gate_m_, {points_.data(), points_.size()}, h.fit)) return;
    if (dull_ > 0 && is_contradicted(RobotFrame(h.fit.pose))) return;
    h.precise = h.fit.residual_m <= precise_gate_m(patch_.scale_px_per_m);
    const float sigma = sigma_m(patch_.scale_px_per_m);
    const float n = static_cast<float>(points_.size()), dull = static_cast<float>(dull_);
    h.value = kPatchReward * (n - 1 - (1 - kPartlyVisibleReward) * dull) -
              0.5f * n * h.fit.residual_m * h.fit.residual_m / (sigma * sigma) -
              kForeignPatchPenalty * static_cast<float>(foreign_team_patches(h.fit.pose));
    if (robot_ >= 0) h.value += kIdentityReward;
    if (patch_.has_axis) {
      const float error = axis_error(h.fit.pose.theta_rad);
      if (std::abs(error) > kAxisGate) return;
      h.value -= 0.5f * error * error / (kAxisSigma * kAxisSigma);
    }
    if (h.value > 0.0f) keep(h);
  }

  // Limits the spread: a set with a larger spread cannot pass the gate or be among the best ones. Two points' distances
  // in the picture and in the layout differ by at most the difference of their errors in the fit. The squared
  // differences of all pairs of n errors add up to n times the sum of the squared errors. So the residual is at least
  // sqrt(spread) / n.
  void limit_spread() {
    most_spread_m2_ = std::numeric_limits<float>::max();
    if (patch_.is_partly_visible) return;
    const float n = static_cast<float>(slots_ + 1 - missing_), sigma = sigma_m(patch_.scale_px_per_m);
    const float most = kPatchReward * (n - 1) + (robot_ >= 0 ? kIdentityReward : 0.0f);
    const float least = found_.full() ? found_.back().value : 0.0f;
    most_spread_m2_ =
        std::min(kRounding * n * n * gate_m_ * gate_m_, 2.0f * (most - least) * kRounding * n * sigma * sigma);
  }

  // Keeps the best hypotheses, best first; of equal ones, the first found.
  void keep(const Hypothesis& h) {
    if (found_.full()) {
      if (h.value <= found_.back().value) return;
      found_.pop_back();
    }
    found_.push_back(h);
    const auto better = [](const Hypothesis& a, const Hypothesis& b) { return a.value > b.value; };
    std::rotate(std::upper_bound(found_.begin(), found_.end() - 1, h, better), found_.end() - 1, found_.end());
    if (found_.full()) limit_spread();
  }

  // Returns true if a region of another color, at least half as large, lies at the position of a dull patch.
  bool is_contradicted(const RobotFrame& to_robot) const {
    for (std::size_t s = 0; s < slots_; ++s) {
      if (set_[s] == kMissing || !patches_.identification[set_[s]].is_partly_visible) continue;
      const PatchCandidate& dull = patches_.identification[set_[s]];
      const FieldPoint place = place_of(layout_.patches[s + 1]);
      const float reach = 0.5f * std::sqrt(area_m2(layout_.patches[s + 1]));
      for (std::size_t i = 0; i < patches_.identification.size(); ++i) {
        const PatchCandidate& other = patches_.identification[i];
        if (other.color == dull.color || other.area_px < kRivalArea * dull.area_px) continue;
        if (std::find(set_.begin(), set_.end(), i) != set_.end()) continue;
        if (distance_m(to_robot(other.at[team_]), place) < reach) return true;
      }
    }
    return false;
  }

  // Evaluates a complete set of identification patches beside a partly visible team patch. Two or more identification
  // patches give the pose. A single one needs the direction to the visible part of the team patch. The position of this
  // part within the team patch is unknown, so the heading is not reported.
  void evaluate_partly_visible(Hypothesis& h, std::span<const Correspondence> identification) {
    if (!is_unique_to_team() || has_other_team_patch()) return;
    const PatchPlace& place = layout_.patches[0];
    if (identification.size() > 1) {
      h.fit = fit_rigidly(identification);
    } else {
      if (patches_.identification[set_[0]].ratio < kCompletePatch) return;
      const Correspondence& only = identification.front();
      const std::array<Correspondence, 2> points{{{place_of(place), patch_.at[team_]}, only}};
      h.fit.pose.theta_rad = fit_rigidly(points).pose.theta_rad;
      const FieldPoint offset = to_robot_frame({{}, -h.fit.pose.theta_rad}, only.place);
      h.fit.pose.position = {only.seen.x_m - offset.x_m, only.seen.y_m - offset.y_m};
      h.has_heading = false;
    }
    if (h.fit.residual_m > precise_gate_m(patch_.scale_px_per_m)) return;
    const float reach = 0.5f * std::hypot(place.length_m, place.width_m);
    if (distance_m(to_robot_frame(h.fit.pose, patch_.at[team_]), place_of(place)) > reach) return;
    h.precise = true;
    h.value = kPartlyVisibleReward * kPatchReward * static_cast<float>(h.seen) -
              kForeignPatchPenalty * static_cast<float>(foreign_team_patches(h.fit.pose));
    if (h.value > 0.0f) keep(h);
  }

  // Returns true if no robot of the other team has the same colors.
  bool is_unique_to_team() const {
    const RobotMarking& robot = marking_.robots[static_cast<std::size_t>(robot_)];
    return std::none_of(others_.robots.begin(), others_.robots.end(), [&](const RobotMarking& other) {
      return std::equal(robot.colors.begin(), robot.colors.end(), other.colors.begin(), other.colors.end());
    });
  }

  // Returns true if the set belongs, or may belong, to another team patch.
  bool has_other_team_patch() const {
    for (const TeamPatch& other : patches_.team) {
      if (other.patch.is_partly_visible) continue;
      for (std::size_t s = 0; s < slots_; ++s) {
        const FieldPoint at = patches_.identification[set_[s]].at[team_];
        if (distance_m(other.patch.at[team_], at) < table_.window(s).high_m) return true;
      }
    }
    return false;
  }

  float axis_error(float theta_rad) const {
    return std::remainder(patch_.axis_rad - theta_rad - principal_variances(layout_.patches[0]).axis_rad,
                          std::numbers::pi_v<float>);
  }

  // Finds the team patches that may be on the top of a robot with this team patch: they are no farther than its
  // diagonal and the errors of its patches.
  void find_rivals() {
    const float reach = 2 * layout_.robot_side_m + 4 * gate_m_;
    for (std::size_t i = 0; i < patches_.team.size(); ++i) {
      const PatchCandidate& other = patches_.team[i].patch;
      if (i == index_ || other.ratio < 0.5f || distance_m(other.at[team_], patch_.at[team_]) > reach) continue;
      rivals_.push_back(other.at[team_]);
    }
  }

  int foreign_team_patches(const Pose& pose) const {
    if (rivals_.empty()) return 0;
    const RobotFrame to_robot(pose);
    return static_cast<int>(std::count_if(rivals_.begin(), rivals_.end(), [&](FieldPoint rival) {
      return on_robot(layout_, to_robot(rival), kForeignPatchInset_m);
    }));
  }

  const PatchLists& patches_;
  std::size_t index_;
  const PatchCandidate& patch_;
  std::size_t team_;
  const TeamMarking &marking_, &others_;
  const MarkerLayout& layout_;
  std::size_t slots_;
  float gate_m_;
  NeighborTable table_;
  FixedVector<Neighbor, kMaxNeighbors> neighbors_;
  FixedVector<FieldPoint, kMaxTeamPatches> rivals_;
  std::array<std::uint16_t, kMaxPatches - 1> set_{};
  std::array<std::uint8_t, kMaxPatches - 1> of_slot_{};  // the patches of set_, as indices of neighbors
  // Team patch and patches of the set. dull_: number of partly visible ones.
  FixedVector<Correspondence, kMaxPatches> points_;
  int dull_ = 0;
  NeighborSet used_ = 0;
  std::int8_t robot_ = -1;
  std::size_t missing_ = 0, missing_left_ = 0;  // number of empty slots: in the whole set, and from the next slot on
  // The patches of earlier slots have wrong distances from each other: sum of the squared errors, for each slot.
  std::array<float, kMaxPatches> spread_m2_{};
  float most_spread_m2_ = 0;
  int work_left_ = 0;
  bool complete_ = true;    // all neighbors fit into the list
  bool exhausted_ = false;  // the search reached its share of the work
  FixedVector<Hypothesis, kMaxPerTeamPatch> found_;
};

}  // namespace

DistanceWindow window_of(const MarkerLayout& layout, std::size_t slot) {
  const PatchPlace& team = layout.patches[0];
  const float expected = distance_m(place_of(team), place_of(layout.patches[slot + 1]));
  // K1 = 3/4 d1 and K2 = d2, extended for layouts with smaller or larger distances than the paper's.
  const float k1 = 0.75f * std::min(team.length_m, team.width_m);
  return {std::min(k1, 0.5f * expected), std::max(layout.robot_side_m, 1.4f * expected)};
}

bool add_hypotheses(const std::array<TeamMarking, 2>& teams, const PatchLists& patches, std::size_t index,
                    WorkBudget<int>& work, Hypotheses& out) {
  Search search(teams, patches, index, work.take());
  const bool complete = search.run(out);
  work.give_back(search.work_left());
  return complete;
}

bool on_robot(const MarkerLayout& layout, FieldPoint point, float inset_m) {
  const float half = 0.5f * layout.robot_side_m - inset_m;
  return std::max(std::abs(point.x_m), std::abs(point.y_m)) < half;
}

}  // namespace touchline
