#include "core/marker/identifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/angle.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// Log likelihood that a patch region has the color of its box: 2 is 7 to 1. (The same pixels count a second time as
// evidence, therefore not more.)
constexpr float kBoxVote = 2.0f;
// Log likelihood that a region where a pose predicts a patch is that patch.
constexpr float kRegionReward = 3.0f;
// Error of the axis of a long team patch, which may be partly hidden or have only a part of its pixels in its box.
constexpr float kRoughAxisSigma = 0.25f;
// A margin above this one needs no exact value: the probability of an error is below the rate of other errors.
constexpr float kClearMargin = 5.0f;
// Margins are divided by this value before they become a probability, because the errors of a robot's patches are not
// independent.
constexpr float kTemperature = 1.5f;
// Log likelihood that a small region of a team color is no robot's team patch.
constexpr float kTentativeDoubt = 3.0f;
// Area of a team patch that is grown from its pixels, relative to the layout's. Halos of sharpening and shared chroma
// leave half of a small patch.
constexpr float kMinGrownArea = 0.35f, kMaxGrownArea = 1.5f;
// A region of the right shape with this part of the area shows the whole patch.
constexpr float kWholeRegion = 0.75f;
// The window for growing contains the patch if its seed is in the middle third.
constexpr float kWindowMargin = 1.3f, kBlur_px = 2.0f;
// Samples of the floor lie on a circle of this radius, relative to the robot's side, around its team patch.
constexpr std::size_t kFloorSamples = 8;
constexpr float kFloorRadius = 1.1f;
// Ratio of variances of patches whose axis is visible: in the layout, and in the picture.
constexpr float kLong = 2.0f, kVisiblyLong = 1.5f;
// Smaller differences of pose show the same pixels.
constexpr float kSamePlace = 0.006f, kSameHeading = 0.2f;
constexpr float kSimilarPlace = 0.02f, kSimilarHeading = 0.5f;
// Standard deviations of the logarithm of a robot's light from that of the field around it: robots are higher than the
// floor, and their gloss differs from that of calibration.
constexpr float kFieldSigma = 0.12f, kFieldTintSigma = 0.06f;
// Samples of a patch are taken within this part of its inner circle.
constexpr float kSampledRadius = 0.5f;

float inner_radius_m(const PatchPlace& place) {
  const float half = 0.5f * std::min(place.length_m, place.width_m);
  if (place.outline != PatchOutline::kTriangle) return half;
  // Radius about the centroid, which is a third of the height above the base.
  const float side = std::hypot(place.length_m, 0.5f * place.width_m);
  return std::min(place.length_m / 3.0f, place.length_m * place.width_m / 3.0f / side);
}

FieldPoint on_field(const Pose& pose, const PatchPlace& place) {
  const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
  return {pose.position.x_m + c * place.x_m - s * place.y_m, pose.position.y_m + s * place.x_m + c * place.y_m};
}

// Not an alternative to each other: the difference is an error of the region's centroid or axis.
bool similar(const Pose& a, const Pose& b) {
  return distance_m(a.position, b.position) < kSimilarPlace &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kSimilarHeading;
}

bool same_pose(const Pose& a, const Pose& b) {
  return distance_m(a.position, b.position) < kSamePlace &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kSameHeading;
}

}  // namespace

struct Identifier::Scene {
  const Frame& frame;
  const ExpectedGain& light;
  const PatchLists& patches;
  std::span<const Hypothesis> hypotheses;
  std::span<const BoxSighting> boxes;
  const Sightings& seen;
  std::size_t team;
};

void Identifier::set_typical(const TypicalColors& typical) {
  colors_.configure(typical);
  set_teams(std::array(teams_));
}

void Identifier::set_teams(const std::array<TeamMarking, 2>& teams) {
  teams_ = teams;
  for (std::size_t t = 0; t < teams.size(); ++t) {
    const TeamMarking& team = teams[t];
    TeamColors& out = team_colors_[t];
    const std::size_t slots = team.layout.patches.empty() ? 0 : team.layout.patches.size() - 1;
    out.usable = team.team_color != kBackground && slots > 0 && !team.robots.empty() && colors_.knows(team.team_color);
    for (std::size_t k = 0; k < team.layout.patches.size(); ++k) {
      out.radius_m[k] = inner_radius_m(team.layout.patches[k]);
    }
    for (std::size_t s = 0; out.usable && s < slots; ++s) {
      SlotColors& slot = out.slots[s];
      slot.colors.clear();
      for (std::size_t r = 0; r < team.robots.size(); ++r) {
        const ColorId color = team.robots[r].colors[s];
        out.usable = out.usable && colors_.knows(color);
        const auto* const known = std::find(slot.colors.begin(), slot.colors.end(), color);
        slot.of_robot[r] = static_cast<std::uint8_t>(known - slot.colors.begin());
        if (known == slot.colors.end()) slot.colors.push_back(color);
      }
    }
  }
}

int Identifier::step_px(const TeamColors& colors, std::size_t patch, float scale_px_per_m) const {
  return std::max(1, static_cast<int>(kSampledRadius * colors.radius_m[patch] * scale_px_per_m));
}

// False if another robot is there.
bool Identifier::is_free(const Scene& now, std::size_t robot, const Pose& pose) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  for (std::size_t i = 0; i < now.seen.robots.size(); ++i) {
    if (i == robot || now.boxes[i].is_tentative) continue;
    const RobotSighting& other = now.seen.robots[i];
    if (other.has_heading) {
      const float side = 0.5f * (layout.robot_side_m + teams_[index_of(other.team)].layout.robot_side_m);
      if (distance_m(pose.position, other.pose.position) < kMinRobotDistance * side) return false;
    }
    const FieldPoint patch = now.patches.team[now.boxes[i].team_patch].patch.at[now.team];
    if (on_robot(layout, to_robot_frame(pose, patch), kForeignPatchInset_m)) return false;
  }
  return true;
}

// A region holds only the part of a patch that fell into its box. The whole patch has a better center and axis.
void Identifier::look_at_team_patch(const Scene& now, Candidate& candidate) const {
  const PatchCandidate& region = now.patches.team[now.boxes[candidate.robot].team_patch].patch;
  candidate.center = region.center;
  candidate.at = region.at[now.team];
  candidate.axis_rad = region.axis_rad;
  candidate.has_axis = region.has_rough_axis;
  candidate.is_complete = true;
  if (candidate.pose_is_sure || (region.has_axis && region.ratio > kWholeRegion)) return;
  const MarkerLayout& layout = teams_[now.team].layout;
  const PatchPlace& place = layout.patches[0];
  const float scale = region.scale_px_per_m, expected_px = area_m2(place) * scale * scale;
  const float reach_px = kWindowMargin * 0.5f * std::hypot(place.length_m, place.width_m) * scale + kBlur_px;
  GrownPatch patch;
  const bool is_grown = grow_patch(now.frame, region.center, reach_px, patch) &&
                        patch.area_px > kMinGrownArea * expected_px && patch.area_px < kMaxGrownArea * expected_px;
  candidate.is_complete = is_grown || !region.is_partly_visible;
  if (!is_grown) return;
  const auto field = [&](PixelPoint pixel) { return camera_.to_field(pixel, layout.height_m); };
  candidate.center = patch.center;
  candidate.at = field(patch.center);
  const PrincipalVariances variances = principal_variances(place);
  candidate.has_axis =
      variances.major_m2 > kLong * variances.minor_m2 && patch.major_px2 > kVisiblyLong * patch.minor_px2;
  if (!candidate.has_axis) return;
  const float du = std::sqrt(patch.major_px2) * std::cos(patch.axis_rad);
  const float dv = std::sqrt(patch.major_px2) * std::sin(patch.axis_rad);
  const FieldPoint a = field({patch.center.u_px + du, patch.center.v_px + dv});
  const FieldPoint b = field({patch.center.u_px - du, patch.center.v_px - dv});
  candidate.axis_rad = std::atan2(a.y_m - b.y_m, a.x_m - b.x_m);
}

// Finds the color of the floor: the median of samples on a circle around the robot.
void Identifier::look_at_floor(const Scene& now, Candidate& candidate) const {
  candidate.has_floor = false;
  if (candidate.pose_is_sure) return;
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  const float radius_px = kFloorRadius * teams_[now.team].layout.robot_side_m * scale;
  std::array<FixedVector<float, kFloorSamples>, 3> values;
  for (std::size_t i = 0; i < kFloorSamples; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kFloorSamples);
    SurfaceColor surface;
    if (!sample_surface(
            now.frame,
            {candidate.center.u_px + radius_px * std::cos(angle), candidate.center.v_px + radius_px * std::sin(angle)},
            1, surface)) {
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(surface.rgb[c]);
  }
  if (values[0].size() < kFloorSamples / 2) return;
  candidate.has_floor = true;
  for (std::size_t c = 0; c < 3; ++c) {
    float* const middle = values[c].begin() + values[c].size() / 2;
    std::nth_element(values[c].begin(), middle, values[c].end());
    candidate.floor.rgb[c] = *middle;
  }
}

float Identifier::prior_of(const Scene& now, const Candidate& candidate, const PoseEvidence& pose) const {
  float prior = 0;
  for (const std::uint16_t number : pose.identification) prior += number == kMissing ? 0.0f : kRegionReward;
  if (candidate.has_axis) {
    const float error = std::remainder(
        candidate.axis_rad - pose.pose.theta_rad - principal_variances(teams_[now.team].layout.patches[0]).axis_rad,
        std::numbers::pi_v<float>);
    prior -= 0.5f * error * error / (kRoughAxisSigma * kRoughAxisSigma);
  }
  return prior;
}

void Identifier::add_pose(const Scene& now, PoseEvidence pose, Candidate& candidate) const {
  if (candidate.poses.full() || !is_free(now, candidate.robot, pose.pose)) return;
  if (std::any_of(candidate.poses.begin(), candidate.poses.end(),
                  [&](const PoseEvidence& other) { return same_pose(other.pose, pose.pose); })) {
    return;
  }
  pose.prior = prior_of(now, candidate, pose);
  candidate.poses.push_back(pose);
}

void Identifier::collect_poses(const Scene& now, Candidate& candidate) const {
  const BoxSighting& box = now.boxes[candidate.robot];
  candidate.pose_is_sure = box.pose_is_sure;
  look_at_team_patch(now, candidate);
  look_at_floor(now, candidate);
  candidate.poses.clear();
  if (candidate.pose_is_sure) {
    const Hypothesis& h = now.hypotheses[box.hypothesis];
    candidate.poses.push_back({h.fit.pose, h.fit.residual_m, h.identification, 0, {}, 0});
    return;
  }
  for (const Hypothesis& h : now.hypotheses) {
    if (h.team_patch != box.team_patch || !h.has_heading) continue;
    add_pose(now, {h.fit.pose, h.fit.residual_m, h.identification, 0, {}, 0}, candidate);
  }
  if (!candidate.has_axis) return;
  const PatchPlace& place = teams_[now.team].layout.patches[0];
  PoseEvidence upright;
  upright.identification.fill(kMissing);
  for (const float turn : {0.0f, std::numbers::pi_v<float>}) {
    upright.pose.theta_rad = wrap_angle(candidate.axis_rad - principal_variances(place).axis_rad + turn);
    const FieldPoint offset = on_field({{}, upright.pose.theta_rad}, place);
    upright.pose.position = {candidate.at.x_m - offset.x_m, candidate.at.y_m - offset.y_m};
    add_pose(now, upright, candidate);
  }
}

LightPrior Identifier::prior_light(const Scene& now, PixelPoint at) {
  LightPrior prior;
  if (!now.light.is_known()) return prior;
  prior.gain = now.light.at(at);
  prior.common_sigma = kFieldSigma;
  if (color_space(now.frame.format) == ColorSpace::kRgb) prior.tint_sigma = kFieldTintSigma;
  return prior;
}

// False if the team patch cannot be sampled.
bool Identifier::evaluate(const Scene& now, Candidate& candidate) const {
  const TeamMarking& team = teams_[now.team];
  const TeamColors& colors = team_colors_[now.team];
  const BoxSighting& box = now.boxes[candidate.robot];
  const ColorSpace space = color_space(now.frame.format);
  const float scale = now.patches.team[box.team_patch].patch.scale_px_per_m;
  SurfaceColor surface;
  if (!sample_surface(now.frame, candidate.center, step_px(colors, 0, scale), surface)) return false;
  const LocalLight light = colors_.light_on(surface, team.team_color, space, prior_light(now, candidate.center));
  for (PoseEvidence& pose : candidate.poses) {
    pose.floor = 0;
    pose.value.fill(pose.prior);
    for (std::size_t s = 0; s + 1 < team.layout.patches.size(); ++s) {
      const SlotColors& slot = colors.slots[s];
      const std::uint16_t number = pose.identification[s];
      const PatchCandidate* const region = number == kMissing ? nullptr : &now.patches.identification[number];
      const PixelPoint center =
          region != nullptr ? region->center
                            : camera_.to_pixel(on_field(pose.pose, team.layout.patches[s + 1]), team.layout.height_m);
      std::array<float, kMaxRobotsPerTeam> likelihood{};
      if (sample_surface(now.frame, center, step_px(colors, s + 1, scale), surface)) {
        for (std::size_t i = 0; i < slot.colors.size(); ++i) {
          const bool in_box = region != nullptr && region->color == slot.colors[i];
          likelihood[i] = colors_.log_likelihood(surface, light, slot.colors[i], space, in_box);
          if (in_box) likelihood[i] += kBoxVote;
        }
        if (candidate.has_floor) {
          pose.floor += ColorEvidence::log_likelihood_of_same(surface, candidate.floor) - ColorEvidence::kNoColor;
        }
      } else {
        likelihood.fill(ColorEvidence::kNoColor);
      }
      for (std::size_t r = 0; r < team.robots.size(); ++r) pose.value[r] += likelihood[slot.of_robot[r]];
    }
  }
  // In the right pose, the least of what should be patches looks like floor.
  float least_floor = std::numeric_limits<float>::max(), best_prior = -least_floor;
  for (const PoseEvidence& pose : candidate.poses) least_floor = std::min(least_floor, pose.floor);
  for (PoseEvidence& pose : candidate.poses) {
    for (std::size_t r = 0; r < team.robots.size(); ++r) {
      pose.value[r] -= pose.floor - least_floor;
      pose.best = r == 0 ? pose.value[r] : std::max(pose.best, pose.value[r]);
    }
    best_prior = std::max(best_prior, pose.prior - (pose.floor - least_floor));
  }
  candidate.unknown = best_prior + static_cast<float>(team.layout.patches.size() - 1) * ColorEvidence::kNoColor;
  if (box.is_tentative) candidate.unknown += kTentativeDoubt;
  return !candidate.poses.empty() && (candidate.is_complete || !box.is_tentative);
}

void Identifier::apply(const Scene& now, const Candidate& candidate, const AssignedId& assigned, std::span<bool> used,
                       Sightings& out) const {
  const TeamMarking& team = teams_[now.team];
  RobotSighting& robot = out.robots[candidate.robot];
  robot.id = kUnknownId;
  const RobotMarking* const name =
      assigned.robot == kNoRobot ? nullptr : &team.robots[static_cast<std::size_t>(assigned.robot)];
  const auto value = [&](const PoseEvidence& pose) {
    return name == nullptr ? pose.best : pose.value[static_cast<std::size_t>(assigned.robot)];
  };
  const PoseEvidence& best =
      *std::max_element(candidate.poses.begin(), candidate.poses.end(),
                        [&](const PoseEvidence& a, const PoseEvidence& b) { return value(a) < value(b); });
  if (!candidate.pose_is_sure) {
    float other = candidate.unknown;
    for (const PoseEvidence& pose : candidate.poses) {
      if (!similar(pose.pose, best.pose)) other = std::max(other, pose.best);
    }
    if (value(best) < other + kDoubtfulMargin) return;
    robot.has_heading = true;
    robot.pose = best.pose;
    robot.residual_m = best.residual_m;
  }
  const PatchCandidate& team_patch = now.patches.team[now.boxes[candidate.robot].team_patch].patch;
  robot.patches.clear();
  robot.patches.push_back({PatchRole::kTeam, 0, team_patch.color, team_patch.center});
  for (std::size_t s = 0; s + 1 < team.layout.patches.size(); ++s) {
    if (best.identification[s] == kMissing) continue;
    used[best.identification[s]] = true;
    const PatchCandidate& patch = now.patches.identification[best.identification[s]];
    // The adaptation must not learn from a region of the wrong color.
    if (name != nullptr && patch.color != name->colors[s]) continue;
    robot.patches.push_back({PatchRole::kIdentification, static_cast<std::uint8_t>(s + 1), patch.color, patch.center});
  }
  if (name == nullptr || assigned.margin < kDoubtfulMargin) return;
  robot.id = name->id;
  robot.confidence = 1.0f / (1.0f + std::exp(-assigned.margin / kTemperature));
}

// Log likelihoods of the names of a robot, over all of its poses.
IdEvidence Identifier::evidence_of(const Scene& now, const Candidate& candidate) const {
  const TeamMarking& team = teams_[now.team];
  IdEvidence out;
  if (!candidate.has_evidence) {
    // It keeps its name, which no other robot may get.
    for (std::size_t r = 0; r < team.robots.size(); ++r) {
      if (team.robots[r].id == now.seen.robots[candidate.robot].id) out.value[r] = 2.0f * kClearMargin;
    }
    return out;
  }
  out.unknown = candidate.unknown;
  out.value = candidate.poses[0].value;
  for (const PoseEvidence& pose : candidate.poses) {
    for (std::size_t r = 0; r < team.robots.size(); ++r) out.value[r] = std::max(out.value[r], pose.value[r]);
  }
  return out;
}

void Identifier::identify(const Frame& frame, const ExpectedGain& light, const PatchLists& patches,
                          std::span<const Hypothesis> hypotheses, std::span<const BoxSighting> boxes,
                          std::span<bool> used, Sightings& out) {
  for (std::size_t t = 0; t < teams_.size(); ++t) {
    if (!team_colors_[t].usable) continue;
    const Scene now{frame, light, patches, hypotheses, boxes, out, t};
    candidates_.clear();
    IdEvidences evidence;
    for (std::size_t i = 0; i < out.robots.size(); ++i) {
      if (index_of(out.robots[i].team) != t || candidates_.full()) continue;
      candidates_.resize(candidates_.size() + 1);
      Candidate& candidate = candidates_.back();
      candidate.robot = i;
      collect_poses(now, candidate);
      candidate.has_evidence = evaluate(now, candidate);
      evidence.push_back(evidence_of(now, candidate));
    }
    AssignedIds assigned;
    assign_ids(evidence, teams_[t].robots.size(), kClearMargin, assigned);
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (candidates_[k].has_evidence) apply(now, candidates_[k], assigned[k], used, out);
    }
  }
}

}  // namespace touchline
