// Distinguishes robots whose names may be exchanged: Identifier::compare_robots() and its helpers.
#include <algorithm>
#include <limits>

#include "core/marker/identifier_scene.h"
#include "core/marker/work_budget.h"

namespace touchline {

const Identifier::PoseEvidence& Identifier::best_pose(const Candidate& candidate, std::size_t name) {
  return *std::max_element(candidate.poses.begin(), candidate.poses.end(),
                           [&](const PoseEvidence& a, const PoseEvidence& b) { return a.value[name] < b.value[name]; });
}

// Measures the border of an identification patch. Returns false if it has no saturated channel, or no visible border.
bool Identifier::border_of(const Scene& now, const Candidate& candidate, const PoseEvidence& pose, std::size_t slot,
                           BorderOfRobot& out) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  const std::uint16_t number = pose.identification[slot];
  const PixelPoint center = number != kMissing
                                ? now.patches.identification[number].center
                                : camera_.to_pixel(on_field(pose.pose, layout.patches[slot + 1]), layout.height_m);
  SurfaceColor surface;
  out.light = candidate.light;
  return now.sample(center, step_px(team_colors_[now.team], slot + 1, scale), surface) &&
         look_at_border(now, center, surface, slot + 1, scale, &pose, out.border);
}

// Returns the log likelihood ratio of two assignments: two robots have these names, or they have the exchanged ones. It
// compares their saturated patches with each other, and subtracts what each patch's own evidence already says.
float Identifier::evidence_of_order(const Scene& now, const NamedCandidate& a, const NamedCandidate& b) const {
  const TeamMarking& team = teams_[now.team];
  const ColorSpace space = color_space(now.frame.format);
  const PoseEvidence &pose_a = best_pose(a.candidate, a.name), &pose_b = best_pose(b.candidate, b.name);
  float gain = 0;
  for (std::size_t s = 0; s + 1 < team.layout.patches.size(); ++s) {
    const ColorId color_a = team.robots[a.name].colors[s], color_b = team.robots[b.name].colors[s];
    if (color_a == color_b) continue;
    BorderOfRobot of_a, of_b;
    if (!border_of(now, a.candidate, pose_a, s, of_a) || !border_of(now, b.candidate, pose_b, s, of_b)) continue;
    const auto likelihood = [&](const BorderOfRobot& seen, ColorId color) {
      return colors_.log_likelihood_of_border(seen.border, seen.light, color, space);
    };
    gain += colors_.log_likelihood_of_order(of_a, color_a, of_b, color_b, space);
    gain -=
        likelihood(of_a, color_a) + likelihood(of_b, color_b) - likelihood(of_a, color_b) - likelihood(of_b, color_a);
  }
  return gain;
}

// Compares pairs of robots whose names are uncertain only because the two robots may be exchanged.
void Identifier::compare_robots(const Scene& now, const IdEvidences& evidence, AssignedIds& assigned) const {
  const std::size_t known = teams_[now.team].robots.size();
  IdEvidences compared = evidence;
  // Margins to alternatives in which only one of two robots has the other's name.
  std::array<float, kMaxRobotsPerTeam> limit{};
  limit.fill(std::numeric_limits<float>::max());
  // Log likelihood ratio of the names of robot i and robot j for robot i.
  const auto margin = [&](std::size_t i, std::size_t j) {
    return evidence[i].value[static_cast<std::size_t>(assigned[i].robot)] -
           evidence[i].value[static_cast<std::size_t>(assigned[j].robot)];
  };
  const auto may_be_exchanged = [&](std::size_t i, std::size_t j) {
    return assigned[i].robot != kNoRobot && assigned[j].robot != kNoRobot && candidates_[i].has_evidence &&
           candidates_[j].has_evidence && margin(i, j) + margin(j, i) < kMinIdMargin;
  };
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) pairs += may_be_exchanged(i, j) ? 1u : 0u;
  }
  if (pairs == 0) return;
  WorkBudget<int> borders(now.borders_left, pairs);
  bool any = false;
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!may_be_exchanged(i, j)) continue;
      const auto a = static_cast<std::size_t>(assigned[i].robot), b = static_cast<std::size_t>(assigned[j].robot);
      const float only_i = margin(i, j), only_j = margin(j, i);
      now.borders_left = borders.take();
      const float gain = evidence_of_order(now, {candidates_[i], a}, {candidates_[j], b});
      borders.give_back(now.borders_left);
      if (gain <= 0.0f) continue;
      // The robot that loses its name gets none, or one that is free.
      const auto loss = [&](std::size_t robot, std::size_t name, std::size_t other) {
        float best = evidence[robot].unknown;
        for (std::size_t k = 0; k < known; ++k) {
          if (k != name && k != other) best = std::max(best, evidence[robot].value[k]);
        }
        return evidence[robot].value[name] - best;
      };
      const float one = std::min(only_i + loss(j, b, a), only_j + loss(i, a, b));
      compared[i].value[b] -= 0.5f * gain;
      compared[j].value[a] -= 0.5f * gain;
      for (const std::size_t k : {i, j}) limit[k] = std::min(limit[k], one);
      any = true;
    }
  }
  now.borders_left = borders.left();
  if (!any) return;
  assign_ids(compared, known, kClearMargin, assigned);
  for (std::size_t k = 0; k < assigned.size(); ++k) assigned[k].margin = std::min(assigned[k].margin, limit[k]);
}

}  // namespace touchline
