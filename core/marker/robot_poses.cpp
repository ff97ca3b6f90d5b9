// Finds the possible poses of a robot: Identifier::collect_poses() and its helpers.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/angle.h"
#include "core/marker/identifier_scene.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// Log odds that a region at the predicted position of a patch is this patch.
constexpr float kRegionReward = 3.0f;
// Log odds of a region that is smaller than a whole patch, and the smallest area ratio that counts. Motion blur or
// occlusion can move the rest of the patch out of all boxes. Smaller regions may be the fringe of another color.
constexpr float kPartReward = 0.5f * kRegionReward, kMinPart = 0.16f;
// Error of the axis of a long team patch, which may be partly hidden or have only a part of its pixels in its box.
constexpr float kRoughAxisSigma = 0.25f;
// Area of a team patch that is grown from its pixels, relative to the layout's. Halos of sharpening and shared chroma
// leave half of a small patch.
constexpr float kMinGrownArea = 0.35f, kMaxGrownArea = 1.5f;
// From this area ratio on, a region of the right shape counts as the whole patch.
constexpr float kWholePatchRatio = 0.75f;
// The window for growing contains the patch if its seed is in the middle third.
constexpr float kWindowMargin = 1.3f, kBlur_px = 2.0f;
// Samples of the floor lie on a circle of this radius, relative to the robot's side, around its team patch.
constexpr std::size_t kSamplesAround = 8;
constexpr float kAroundRadius = 1.1f;
// Number of directions that are searched around a team patch. In adjacent directions, the places of an identification
// patch overlap by most of a patch. kManyDirections is the logarithm of their number: each of them may show a known
// color by chance.
constexpr std::size_t kDirections = 16;
constexpr float kManyDirections = 2.8f;
// kFourDirections is the logarithm of 4, the number of directions that the sides of a square team patch allow.
// kSideError is the error of these sides in radians.
constexpr float kFourDirections = 1.4f, kSideError = 0.2f, kMinSquareness = 0.5f;
// Smallest ratio of variances of a patch whose axis is visible: in the layout, and in the picture.
constexpr float kLong = 2.0f, kVisiblyLong = 1.5f;
// Two poses that differ by less than these would be evaluated from the same pixels, so only the first is kept.
constexpr float kSamePlace = 0.006f, kSameHeading = 0.2f;

// The sides of a square are tested at this distance from its edge, and along a part of each side. Relative to the
// patch's brightness, pixels outside must be darker than kDarkTop, and pixels inside at least as bright as
// kSameSurface.
constexpr float kClearOfEdge_px = 2.5f, kClearOfSide = 0.5f, kDarkTop = 0.5f, kSameSurface = 0.8f;

bool is_square(const PatchPlace& place) {
  return place.outline == PatchOutline::kSquare && std::abs(place.length_m - place.width_m) < 0.05f * place.length_m;
}

// Returns the RMS residual of the best rigid fit of two points whose distance is `seen_m` instead of `expected_m`.
float residual_of_distance_m(float seen_m, float expected_m) { return 0.5f * std::abs(seen_m - expected_m); }

bool same_pose(const Pose& a, const Pose& b) {
  return distance_m(a.position, b.position) < kSamePlace &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kSameHeading;
}

}  // namespace

// Returns false if another robot occupies the place of the pose.
bool Identifier::is_free(const Scene& now, std::size_t robot, const PoseEvidence& evidence) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  const Pose& pose = evidence.pose;
  const RobotFrame to_robot(pose);
  for (std::size_t i = 0; i < now.seen.robots.size(); ++i) {
    if (i == robot || now.boxes[i].is_tentative) continue;
    if (now.boxes[i].team_patch == evidence.partner && !now.boxes[i].pose_is_sure) continue;
    const RobotSighting& other = now.seen.robots[i];
    if (other.has_heading) {
      const float side = 0.5f * (layout.robot_side_m + teams_[index_of(other.team)].layout.robot_side_m);
      if (distance_m(pose.position, other.pose.position) < kMinRobotDistance * side) return false;
    }
    const FieldPoint patch = now.patches.team[now.boxes[i].team_patch].patch.at[now.team];
    if (on_robot(layout, to_robot(patch), kForeignPatchInset_m)) return false;
  }
  return true;
}

// Finds center and axis of the team patch. A region contains only the part of the patch that fell into its box, so a
// patch grown from its pixels gives a better center and axis, unless another surface of a similar color touches it.
// Therefore both views are kept. The light is measured on the first one.
void Identifier::look_at_team_patch(const Scene& now, Candidate& candidate) const {
  const PatchCandidate& region = now.patches.team[now.boxes[candidate.robot].team_patch].patch;
  const TeamPatchView of_region{region.center, region.at[now.team], region.axis_rad, region.has_rough_axis};
  candidate.views.clear();
  candidate.views.push_back(of_region);
  candidate.is_complete = true;
  if (candidate.pose_is_sure || (region.has_axis && region.ratio > kWholePatchRatio)) return;
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
  const PrincipalVariances variances = principal_variances(place);
  TeamPatchView whole{patch.center, field(patch.center)};
  whole.has_axis = variances.major_m2 > kLong * variances.minor_m2 && patch.major_px2 > kVisiblyLong * patch.minor_px2;
  if (whole.has_axis) {
    const float du = std::sqrt(patch.major_px2) * std::cos(patch.axis_rad);
    const float dv = std::sqrt(patch.major_px2) * std::sin(patch.axis_rad);
    const FieldPoint a = field({patch.center.u_px + du, patch.center.v_px + dv});
    const FieldPoint b = field({patch.center.u_px - du, patch.center.v_px - dv});
    whole.axis_rad = std::atan2(a.y_m - b.y_m, a.x_m - b.x_m);
  }
  if (is_square(place) && patch.squareness > kMinSquareness) {
    const float du = reach_px * std::cos(patch.side_rad), dv = reach_px * std::sin(patch.side_rad);
    const FieldPoint a = field({patch.center.u_px + du, patch.center.v_px + dv});
    const FieldPoint b = field({patch.center.u_px - du, patch.center.v_px - dv});
    whole.has_sides = true;
    whole.side_rad = std::atan2(a.y_m - b.y_m, a.x_m - b.x_m);
  }
  candidate.views[0] = whole;
  if (!region.is_partly_visible) candidate.views.push_back(of_region);
}

// Finds the color of the floor: the median of samples on a circle around the robot.
void Identifier::look_at_floor(const Scene& now, Candidate& candidate) const {
  candidate.has_floor = false;
  if (candidate.pose_is_sure) return;
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  const float radius_px = kAroundRadius * teams_[now.team].layout.robot_side_m * scale;
  std::array<FixedVector<float, kSamplesAround>, 3> values;
  for (std::size_t i = 0; i < kSamplesAround; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kSamplesAround);
    SurfaceColor surface;
    if (!now.sample({candidate.views[0].center.u_px + radius_px * std::cos(angle),
                     candidate.views[0].center.v_px + radius_px * std::sin(angle)},
                    1, surface)) {
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(surface.rgb[c]);
  }
  if (values[0].size() < kSamplesAround / 2) return;
  candidate.has_floor = true;
  for (std::size_t c = 0; c < 3; ++c) {
    float* const middle = values[c].begin() + values[c].size() / 2;
    std::nth_element(values[c].begin(), middle, values[c].end());
    candidate.floor.rgb[c] = *middle;
  }
}

float Identifier::prior_of(const Scene& now, const Candidate& candidate, const PoseEvidence& pose) const {
  float prior = 0;
  for (const std::uint16_t number : pose.identification) {
    if (number == kMissing) continue;
    prior += now.patches.identification[number].is_partly_visible ? kPartReward : kRegionReward;
  }
  float least_error = std::numeric_limits<float>::max();
  for (const TeamPatchView& view : candidate.views) {
    if (!view.has_axis) continue;
    const float error = std::remainder(
        view.axis_rad - pose.pose.theta_rad - principal_variances(teams_[now.team].layout.patches[0]).axis_rad,
        std::numbers::pi_v<float>);
    least_error = std::min(least_error, std::abs(error));
  }
  if (least_error < std::numeric_limits<float>::max()) {
    prior -= 0.5f * least_error * least_error / (kRoughAxisSigma * kRoughAxisSigma);
  }
  if (pose.partner != kMissing) prior += kRegionReward;
  if (pose.is_grown) prior += kPartReward;
  return prior - pose.search_doubt;
}

void Identifier::add_pose(const Scene& now, PoseEvidence pose, Candidate& candidate) const {
  if (candidate.poses.full() || !is_free(now, candidate.robot, pose)) return;
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
  look_at_light(now, candidate);
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
  add_saturated_patches(now, candidate);
  add_poses_through_parts(now, candidate);
  add_upright_poses(now, candidate);
  if (candidate.has_axis() || !candidate.poses.empty() || !candidate.is_complete) return;
  search_poses(now, candidate);
  if (candidate.poses.empty()) add_poses_along_sides(now, candidate);
}

// Adds both poses that the axis of a long team patch allows.
void Identifier::add_upright_poses(const Scene& now, Candidate& candidate) const {
  const PatchPlace& place = teams_[now.team].layout.patches[0];
  for (const TeamPatchView& view : candidate.views) {
    if (!view.has_axis) continue;
    PoseEvidence upright;
    for (const float turn : {0.0f, std::numbers::pi_v<float>}) {
      upright.pose.theta_rad = wrap_angle(view.axis_rad - principal_variances(place).axis_rad + turn);
      const FieldPoint offset = on_field({{}, upright.pose.theta_rad}, place);
      upright.pose.position = {view.at.x_m - offset.x_m, view.at.y_m - offset.y_m};
      claim_part(now, upright);
      add_pose(now, upright, candidate);
    }
  }
}

// Returns whether the region is too small for a whole patch, but has a color that the first identification patch may
// have.
bool Identifier::is_part(const Scene& now, const PatchCandidate& region) const {
  const auto& colors = team_colors_[now.team].slots[0].colors;
  return region.is_partly_visible && region.ratio >= kMinPart &&
         std::find(colors.begin(), colors.end(), region.color) != colors.end();
}

// Assigns to the pose the largest visible part of the only identification patch, if the pose predicts the patch at this
// position. Layouts with more patches do not need such parts: complete patches give the pose, and color fringes would
// confirm wrong poses.
void Identifier::claim_part(const Scene& now, PoseEvidence& pose) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  pose.identification.fill(kMissing);
  if (layout.patches.size() != 2) return;
  const PatchPlace& place = layout.patches[1];
  const RobotFrame to_robot(pose.pose);
  float largest_px = 0;
  for (std::size_t i = 0; i < now.patches.identification.size(); ++i) {
    const PatchCandidate& region = now.patches.identification[i];
    if (region.area_px <= largest_px || !is_part(now, region)) continue;
    const FieldPoint at = to_robot(region.at[now.team]);
    if (std::abs(at.x_m - place.x_m) > 0.5f * place.length_m || std::abs(at.y_m - place.y_m) > 0.5f * place.width_m) {
      continue;
    }
    largest_px = region.area_px;
    pose.identification[0] = static_cast<std::uint16_t>(i);
  }
}

// Adds poses through the team patch and a part of the only identification patch, because the axis of a blurred or
// partly hidden team patch may be wrong.
void Identifier::add_poses_through_parts(const Scene& now, Candidate& candidate) const {
  if (teams_[now.team].layout.patches.size() != 2) return;
  for (std::size_t i = 0; i < now.patches.identification.size(); ++i) {
    const PatchCandidate& region = now.patches.identification[i];
    if (!is_part(now, region)) continue;
    for (const TeamPatchView& view : candidate.views) {
      PoseEvidence pose;
      if (!place_through(now, candidate, view.at, 0, region.at[now.team], pose)) continue;
      pose.identification.fill(kMissing);
      pose.identification[0] = static_cast<std::uint16_t>(i);
      add_pose(now, pose, candidate);
    }
  }
}

// Aligns the pose with the first identification patch, whose center is measured by growing it from its pixels. Returns
// false if no patch of the right size is at the right distance.
bool Identifier::align(const Scene& now, const Candidate& candidate, PoseEvidence& pose) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  const PatchPlace& place = layout.patches[1];
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  const float reach_px = kWindowMargin * 0.5f * std::hypot(place.length_m, place.width_m) * scale + kBlur_px;
  const float expected_px = area_m2(place) * scale * scale;
  // The pose predicts the patch to within half of its size.
  GrownPatch patch;
  if (!grow_patch(now.frame, camera_.to_pixel(on_field(pose.pose, place), layout.height_m), reach_px, patch) ||
      patch.area_px < kMinGrownArea * expected_px || patch.area_px > kMaxGrownArea * expected_px) {
    return false;
  }
  const FieldPoint at = camera_.to_field(patch.center, layout.height_m);
  return place_through(now, candidate, candidate.views[0].at, 0, at, pose);
}

// Computes the pose from the seen positions of its team patch and one identification patch. Returns false if their
// distance differs from the layout's.
bool Identifier::place_through(const Scene& now, const Candidate& candidate, FieldPoint team_patch, std::size_t slot,
                               FieldPoint at, PoseEvidence& pose) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  const PatchPlace &team_place = layout.patches[0], &place = layout.patches[slot + 1];
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  const FieldPoint layout_offset{place.x_m - team_place.x_m, place.y_m - team_place.y_m};
  const FieldPoint offset{at.x_m - team_patch.x_m, at.y_m - team_patch.y_m};
  pose.residual_m =
      residual_of_distance_m(std::hypot(offset.x_m, offset.y_m), std::hypot(layout_offset.x_m, layout_offset.y_m));
  if (pose.residual_m > precise_gate_m(scale)) return false;
  pose.pose.theta_rad =
      wrap_angle(std::atan2(offset.y_m, offset.x_m) - std::atan2(layout_offset.y_m, layout_offset.x_m));
  const FieldPoint from_middle = on_field({{}, pose.pose.theta_rad}, {.x_m = 0.5f * (team_place.x_m + place.x_m),
                                                                      .y_m = 0.5f * (team_place.y_m + place.y_m)});
  pose.pose.position = {0.5f * (team_patch.x_m + at.x_m) - from_middle.x_m,
                        0.5f * (team_patch.y_m + at.y_m) - from_middle.y_m};
  return true;
}

// Returns the log likelihood ratio, at the team patch's border, of the likeliest color of the slot against the team
// color.
float Identifier::doubt_of_team_patch(const Scene& now, const Candidate& candidate, std::size_t slot) const {
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  SurfaceColor surface;
  BorderColor border;
  if (!now.sample(candidate.views[0].center, step_px(team_colors_[now.team], 0, scale), surface) ||
      !look_at_border(now, candidate.views[0].center, surface, 0, scale, nullptr, border)) {
    return 0.0f;
  }
  const auto likelihood = [&](ColorId color) {
    return colors_.log_likelihood_of_border(border, candidate.light, color, color_space(now.frame.format));
  };
  const float team = likelihood(teams_[now.team].team_color);
  float best = team;
  for (const ColorId color : team_colors_[now.team].slots[slot].colors) best = std::max(best, likelihood(color));
  return best - team;
}

// Adds poses in which another region of the team color is an identification patch: saturation can move an
// identification patch into the team color's box.
void Identifier::add_saturated_patches(const Scene& now, Candidate& candidate) const {
  if (!candidate.has_light) return;
  const MarkerLayout& layout = teams_[now.team].layout;
  const std::uint16_t own = now.boxes[candidate.robot].team_patch;
  const FieldPoint here = candidate.views[0].at;
  const float gate_m = precise_gate_m(now.patches.team[own].patch.scale_px_per_m);
  std::array<float, kMaxPatches - 1> expected_m{};
  for (std::size_t s = 0; s + 1 < layout.patches.size(); ++s) {
    const PatchPlace &team_place = layout.patches[0], &place = layout.patches[s + 1];
    expected_m[s] = distance_m({team_place.x_m, team_place.y_m}, {place.x_m, place.y_m});
  }
  for (std::size_t i = 0; i < now.patches.team.size(); ++i) {
    const TeamPatch& other = now.patches.team[i];
    if (i == own || index_of(other.team) != now.team) continue;
    const float seen_m = distance_m(here, other.patch.at[now.team]);
    for (std::size_t s = 0; s + 1 < layout.patches.size(); ++s) {
      if (residual_of_distance_m(seen_m, expected_m[s]) > gate_m) continue;
      PoseEvidence pose;
      pose.identification.fill(kMissing);
      pose.partner = static_cast<std::uint16_t>(i);
      if (!place_through(now, candidate, here, s, other.patch.at[now.team], pose)) continue;
      SurfaceColor surface;
      if (!now.sample(other.patch.center, step_px(team_colors_[now.team], s + 1, other.patch.scale_px_per_m),
                      surface) ||
          surface.saturated_channels() < 2) {
        continue;
      }
      pose.search_doubt = doubt_of_team_patch(now, candidate, s);
      add_pose(now, pose, candidate);
    }
  }
}

// Adds poses in the four directions that the sides of a square team patch allow. This helps if the identification patch
// is merged with a surface of its color, so that only one corner of the patch is visible.
void Identifier::add_poses_along_sides(const Scene& now, Candidate& candidate) const {
  const TeamPatchView& view = candidate.views[0];
  const PatchPlace& place = teams_[now.team].layout.patches[0];
  if (!view.has_sides) return;
  for (int quarter = 0; quarter < 4; ++quarter) {
    PoseEvidence pose;
    pose.pose.theta_rad =
        wrap_angle(view.side_rad - place.turn_rad + 0.5f * std::numbers::pi_v<float> * static_cast<float>(quarter));
    const FieldPoint offset = on_field({{}, pose.pose.theta_rad}, place);
    pose.pose.position = {view.at.x_m - offset.x_m, view.at.y_m - offset.y_m};
    pose.identification.fill(kMissing);
    pose.search_doubt = kFourDirections;
    pose.is_merged = true;
    if (has_visible_corner(now, pose)) add_pose(now, pose, candidate);
  }
}

// Returns whether the only identification patch, a square, ends at two adjacent sides in front of the robot's darker
// top.
bool Identifier::has_visible_corner(const Scene& now, const PoseEvidence& pose) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  if (layout.patches.size() != 2 || !is_square(layout.patches[1])) return false;
  const PatchPlace& place = layout.patches[1];
  const PixelPoint center = camera_.to_pixel(on_field(pose.pose, place), layout.height_m);
  const auto sum_at = [&](float along_m, float across_m, float& sum) {
    PatchPlace at = place;
    at.x_m += std::cos(place.turn_rad) * along_m - std::sin(place.turn_rad) * across_m;
    at.y_m += std::sin(place.turn_rad) * along_m + std::cos(place.turn_rad) * across_m;
    SurfaceColor surface;
    const bool on_top = on_robot(layout, {at.x_m, at.y_m}, 0.0f);
    if (!on_top || !now.sample(camera_.to_pixel(on_field(pose.pose, at), layout.height_m), 1, surface)) {
      return false;
    }
    sum = surface.rgb[0] + surface.rgb[1] + surface.rgb[2];
    return true;
  };
  const float half = 0.5f * place.length_m;
  const PixelPoint side =
      camera_.to_pixel(on_field(pose.pose, {.x_m = place.x_m + half, .y_m = place.y_m}), layout.height_m);
  const float scale = std::hypot(side.u_px - center.u_px, side.v_px - center.v_px) / half;
  const float beyond = half + kClearOfEdge_px / scale, within = kClearOfSide * half;
  float patch = 0;
  if (!sum_at(0, 0, patch)) return false;
  // Returns whether the side in direction (x, y) of the patch is on the robot, with a dark top beyond it.
  const auto ends = [&](float x, float y) {
    for (const float along : {-within, 0.0f, within}) {
      float outside = 0, inside = 0;
      if (!sum_at(x * beyond - y * along, y * beyond + x * along, outside) || outside > kDarkTop * patch) return false;
      if (!sum_at(x * within - y * along, y * within + x * along, inside) || inside < kSameSurface * patch)
        return false;
    }
    return true;
  };
  return (ends(1, 0) || ends(-1, 0)) && (ends(0, 1) || ends(0, -1));
}

// Searches all directions around the team patch for identification patches that fell into no box. Adds the two
// likeliest poses. A direction along the sides of a square team patch has a higher prior.
void Identifier::search_poses(const Scene& now, Candidate& candidate) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  if (!candidate.has_light) return;
  std::array<float, kDirections> value{};
  std::array<Pose, kDirections> poses{};
  for (std::size_t i = 0; i < kDirections; ++i) {
    poses[i].theta_rad = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kDirections);
    const FieldPoint offset = on_field(poses[i], layout.patches[0]);
    poses[i].position = {candidate.views[0].at.x_m - offset.x_m, candidate.views[0].at.y_m - offset.y_m};
    for (std::size_t s = 0; s + 1 < layout.patches.size(); ++s) {
      value[i] += best_likelihood(now, candidate, poses[i], s);
    }
  }
  // Drop directions that are much less likely than the best one.
  float least = ColorEvidence::kNoColor * static_cast<float>(layout.patches.size() - 1);
  for (int tried = 0; tried < 2; ++tried) {
    const auto best = static_cast<std::size_t>(std::max_element(value.begin(), value.end()) - value.begin());
    if (value[best] < least) return;
    least = std::max(least, value[best] - 2.0f * kMinIdMargin);
    PoseEvidence pose;
    pose.pose = poses[best];
    pose.identification.fill(kMissing);
    pose.search_doubt = kManyDirections;
    if (align(now, candidate, pose)) {
      const TeamPatchView& view = candidate.views[0];
      const float error = std::remainder(pose.pose.theta_rad + layout.patches[0].turn_rad - view.side_rad,
                                         0.5f * std::numbers::pi_v<float>);
      if (view.has_sides && std::abs(error) < kSideError) pose.search_doubt = kFourDirections;
      pose.is_grown = true;
      add_pose(now, pose, candidate);
    }
    for (const std::size_t near : {best + kDirections - 1, best, best + 1}) {
      value[near % kDirections] = std::numeric_limits<float>::lowest();
    }
  }
}

}  // namespace touchline
