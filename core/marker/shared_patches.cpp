// Resolves patches that several robots may have: Identifier::share_patches() and its helpers.
#include <algorithm>
#include <array>
#include <limits>

#include "core/marker/identifier_scene.h"

namespace touchline {
namespace {

// Log likelihood ratio up to which a pose that needs another robot's patch and a pose that does not are equally good.
constexpr float kNearlyAsWell = 1.0f;

}  // namespace

// Predicted positions of the identification patches in all poses of a candidate.
class Identifier::PredictedPatches {
 public:
  void predict(const Candidate& candidate, std::span<const PatchPlace> places, std::span<const float> radius_m) {
    radius_m_ = radius_m;
    low_ = {std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
    high_ = {std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest()};
    float reach = 0;
    for (const float radius : radius_m) reach = std::max(reach, kRoundingMargin * radius);
    for (std::size_t p = 0; p < candidate.poses.size(); ++p) {
      const RobotOnField on_field(candidate.poses[p].pose);
      for (std::size_t s = 0; s < places.size(); ++s) {
        const FieldPoint at = center_[p][s] = on_field(places[s]);
        low_ = {std::min(low_.x_m, at.x_m - reach), std::min(low_.y_m, at.y_m - reach)};
        high_ = {std::max(high_.x_m, at.x_m + reach), std::max(high_.y_m, at.y_m + reach)};
      }
    }
  }
  [[nodiscard]] FieldPoint center(std::size_t pose, std::size_t slot) const { return center_[pose][slot]; }
  /// Returns false if no pose has a patch at this position.
  [[nodiscard]] bool may_need(FieldPoint at) const {
    return at.x_m >= low_.x_m && at.x_m <= high_.x_m && at.y_m >= low_.y_m && at.y_m <= high_.y_m;
  }
  [[nodiscard]] bool needs(std::size_t pose, FieldPoint at) const {
    for (std::size_t s = 0; s < radius_m_.size(); ++s) {
      if (distance_m(center_[pose][s], at) < radius_m_[s]) return true;
    }
    return false;
  }
  /// Returns the log likelihood of the best explanation by a pose without a patch at this position.
  [[nodiscard]] float best_without(const Candidate& candidate, FieldPoint at) const {
    float best = std::numeric_limits<float>::lowest();
    for (std::size_t p = 0; p < candidate.poses.size(); ++p) {
      if (!needs(p, at)) best = std::max(best, candidate.poses[p].best);
    }
    return best;
  }

 private:
  static constexpr float kRoundingMargin = 1.01f;

  std::span<const float> radius_m_;  // radius of the circle inside each patch, by slot
  std::array<std::array<FieldPoint, kMaxPatches - 1>, kMaxPoses> center_{};
  FieldPoint low_, high_;  // corners of a box around all patches
};

// A patch belongs to a single robot. If a robot has no good explanation without a contested patch, poses of other
// robots in its team that need the patch are penalized in three cases: their team patch is uncertain; another pose
// explains their robot equally well without the patch; or the joint log likelihood of both robots is lower if they get
// the patch.
void Identifier::share_patches(const Scene& now) {
  const std::span<const PatchPlace> places(teams_[now.team].layout.patches.begin() + 1,
                                           teams_[now.team].layout.patches.end());
  const std::span<const float> radius_m(team_colors_[now.team].radius_m.begin() + 1, places.size());
  std::array<PredictedPatches, kMaxRobotsPerTeam> predicted;
  for (std::size_t k = 0; k < candidates_.size(); ++k) predicted[k].predict(candidates_[k], places, radius_m);
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    Candidate& owner = candidates_[k];
    if (!owner.has_evidence || now.boxes[owner.robot].is_tentative) continue;
    const auto best =
        static_cast<std::size_t>(std::max_element(owner.poses.begin(), owner.poses.end(),
                                                  [](const auto& a, const auto& b) { return a.best < b.best; }) -
                                 owner.poses.begin());
    const PoseEvidence& own = owner.poses[best];
    for (std::size_t s = 0; s < places.size(); ++s) {
      const FieldPoint at = predicted[k].center(best, s);
      const float loss = own.best - std::max(owner.unknown, predicted[k].best_without(owner, at));
      if (loss < kMinIdMargin) continue;
      for (std::size_t i = 0; i < candidates_.size(); ++i) {
        Candidate& other = candidates_[i];
        if (i == k || !other.has_evidence || other.pose_is_sure) continue;
        if (now.boxes[other.robot].is_tentative) {
          const bool is_patch = distance_m(other.views[0].at, at) < radius_m[s];
          for (std::size_t p = 0; p < other.poses.size(); ++p) {
            if (is_patch || predicted[i].needs(p, at)) other.poses[p].costs = kMinIdMargin;
          }
          continue;
        }
        if (!predicted[i].may_need(at)) continue;
        const float without = predicted[i].best_without(other, at);
        for (std::size_t p = 0; p < other.poses.size(); ++p) {
          if (!predicted[i].needs(p, at)) continue;
          PoseEvidence& pose = other.poses[p];
          const float gain = pose.best - std::max(other.unknown, without);
          if (pose.best <= without + kNearlyAsWell) {
            pose.costs = std::max(pose.costs, kMinIdMargin);
          } else if (without > other.unknown && loss >= gain + kMinIdMargin) {
            pose.costs = std::max(pose.costs, loss);
            // It may still be the other robot's patch.
            owner.unknown = std::max(owner.unknown, own.best - loss + gain);
          }
        }
      }
    }
  }
  for (Candidate& candidate : candidates_) {
    for (PoseEvidence& pose : candidate.poses) {
      for (float& value : pose.value) value -= pose.costs;
      pose.best -= pose.costs;
    }
  }
}

}  // namespace touchline
