#include "core/marker/identifier.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

#include "core/geometry/angle.h"
#include "core/marker/border_color.h"
#include "core/marker/clipping_level.h"
#include "core/marker/identifier_scene.h"
#include "core/marker/work_budget.h"

namespace touchline {
namespace {

// Log odds that a patch region has the color of its box: 2 means 7 to 1. A larger value would be wrong, because the
// pixels of the region also count as evidence. It applies only to surfaces whose spread is below kUneven_levels: the
// edge of another surface may have pixels of any color. White pixels may lie in the boxes of several colors, and only
// the first of these boxes is known.
constexpr float kBoxVote = 2.0f, kUneven_levels = 25.0f;
// Prior log odds that a small region of a team color is not a robot's team patch.
constexpr float kTentativeDoubt = 3.0f;
// Log-odds penalty for stripes: the positions of all identification patches show the team color.
constexpr float kTeamColorDoubt = 3.0f;
constexpr float kSimilarPlace = 0.02f, kSimilarHeading = 0.5f;
// Samples of a patch are taken within this part of its inner circle.
constexpr float kSampledRadius = 0.5f;
// The border of a saturated patch is looked for from this part of its inner circle to beyond its blurred corners.
constexpr float kBorderFrom = 0.4f, kBorderBlur_px = 3.0f;

// Returns the number of a team's robots that are examined.
std::size_t robots_of(const Sightings& seen, std::size_t team) {
  const auto robots = std::count_if(seen.robots.begin(), seen.robots.end(),
                                    [&](const RobotSighting& robot) { return index_of(robot.team) == team; });
  return std::min(static_cast<std::size_t>(robots), kMaxRobotsPerTeam);
}

float inner_radius_m(const PatchPlace& place) {
  const float half = 0.5f * std::min(place.length_m, place.width_m);
  if (place.outline != PatchOutline::kTriangle) return half;
  // Radius about the centroid, which is a third of the height above the base.
  const float side = std::hypot(place.length_m, 0.5f * place.width_m);
  return std::min(place.length_m / 3.0f, place.length_m * place.width_m / 3.0f / side);
}

// Returns whether another color, or none, is nearly as likely as the likeliest one.
bool is_uncertain(std::span<const float> likelihood) {
  float best = ColorEvidence::kFloor, second = ColorEvidence::kNoColor;
  for (const float value : likelihood) {
    second = std::max(second, std::min(best, value));
    best = std::max(best, value);
  }
  return best - second < kClearMargin;
}

// Returns whether two poses differ by no more than the error of a region's centroid or axis, and so are no
// alternatives.
bool similar(const Pose& a, const Pose& b) {
  return distance_m(a.position, b.position) < kSimilarPlace &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kSimilarHeading;
}

}  // namespace

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
    out.usable = colors_.can_name(team);
    for (std::size_t k = 0; k < team.layout.patches.size(); ++k) {
      out.radius_m[k] = inner_radius_m(team.layout.patches[k]);
    }
    for (std::size_t s = 0; out.usable && s < slots; ++s) {
      SlotColors& slot = out.slots[s];
      slot.colors.clear();
      for (std::size_t r = 0; r < team.robots.size(); ++r) {
        const ColorId color = team.robots[r].colors[s];
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

// Samples the border of a patch with a saturated channel. Returns false if it is not visible enough. If a pose is
// given, two visible sides are enough.
bool Identifier::look_at_border(const Scene& now, PixelPoint center, const SurfaceColor& surface, std::size_t patch,
                                float scale_px_per_m, const PoseEvidence* pose, BorderColor& out) const {
  if (surface.saturated_channels() == 0 || now.borders_left == 0) return false;
  --now.borders_left;
  const PatchPlace& place = teams_[now.team].layout.patches[patch];
  const float inner_px = kBorderFrom * team_colors_[now.team].radius_m[patch] * scale_px_per_m;
  const float reach_px = 0.5f * std::hypot(place.length_m, place.width_m) * scale_px_per_m + kBorderBlur_px;
  if (!sample_border(now.frame, center, surface, inner_px, reach_px, out, kRaysOfTwoSides)) return false;
  return out.rays >= kMinBorderRays || (pose != nullptr && (pose->is_merged || has_visible_corner(now, *pose)));
}

void Identifier::look_at_light(const Scene& now, Candidate& candidate) const {
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  SurfaceColor surface;
  candidate.has_light = now.sample(candidate.views[0].center, step_px(team_colors_[now.team], 0, scale), surface);
  if (!candidate.has_light) return;
  candidate.light = colors_.light_on(surface, teams_[now.team].team_color, color_space(now.frame.format),
                                     expected_light(now.light, candidate.views[0].center));
  now.expected.light = nullptr;
}

// Returns the log likelihoods of the colors of a slot, followed by the team color. `box`: class of the surface's
// region, or kBackground. `on_robot`: the candidate's light. The expected colors are cached until the light of another
// team patch is measured.
Identifier::SlotLikelihoods Identifier::likelihoods(const Scene& now, const LocalLight& on_robot, std::size_t slot,
                                                    const SurfaceColor& surface, ColorId box) const {
  const auto& colors = team_colors_[now.team].slots[slot].colors;
  const std::size_t count = colors.size() + 1;
  const auto color = [&](std::size_t i) { return i < colors.size() ? colors[i] : teams_[now.team].team_color; };
  ExpectedColors& expected = now.expected;
  if (expected.light != &on_robot) {
    expected.light = &on_robot;
    expected.is_known.fill(false);
  }
  auto& groups = expected.of_slot[slot];
  if (!std::exchange(expected.is_known[slot], true)) {
    // A group that is not full repeats the last color.
    for (std::size_t i = 0; i < (count + 3) / 4 * 4; ++i) {
      groups[i / 4].set(i % 4,
                        colors_.expected_color(on_robot, color(std::min(i, count - 1)), color_space(now.frame.format)));
    }
  }
  SlotLikelihoods out{};
  const auto of_box = static_cast<std::size_t>(std::find(colors.begin(), colors.end(), box) - colors.begin());
  for (std::size_t group = 0; 4 * group < count; ++group) {
    Simd4<std::int32_t> in_box{};
    if (of_box < colors.size() && of_box / 4 == group) in_box[of_box % 4] = -1;
    const Simd4<float> four = ColorEvidence::log_likelihoods(surface, groups[group], on_robot.glare, in_box);
    std::memcpy(&out[4 * group], &four, sizeof four);
  }
  return out;
}

// Returns the log likelihood of the likeliest color of a patch in this pose.
float Identifier::best_likelihood(const Scene& now, const Candidate& candidate, const Pose& pose,
                                  std::size_t slot) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  const PixelPoint center = camera_.to_pixel(on_field(pose, layout.patches[slot + 1]), layout.height_m);
  SurfaceColor surface;
  if (!now.sample(center, step_px(team_colors_[now.team], slot + 1, scale), surface)) return ColorEvidence::kFloor;
  const SlotLikelihoods of_color = likelihoods(now, candidate.light, slot, surface, kBackground);
  const std::size_t colors = team_colors_[now.team].slots[slot].colors.size();
  return *std::max_element(of_color.begin(), of_color.begin() + static_cast<std::ptrdiff_t>(colors));
}

// Returns whether every pose of a robot uses an identification region that another robot may own. In this case, the
// robot's own patch may have fallen into no box.
bool Identifier::has_only_claimed_regions(const Candidate& candidate) const {
  const auto is_claimed = [&](std::uint16_t number) {
    return number != kMissing && std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& other) {
             return &other != &candidate &&
                    std::any_of(other.poses.begin(), other.poses.end(), [&](const PoseEvidence& pose) {
                      return std::find(pose.identification.begin(), pose.identification.end(), number) !=
                             pose.identification.end();
                    });
           });
  };
  return !candidate.pose_is_sure && !candidate.has_axis() && candidate.is_complete && !candidate.poses.empty() &&
         std::all_of(candidate.poses.begin(), candidate.poses.end(), [&](const PoseEvidence& pose) {
           return std::any_of(pose.identification.begin(), pose.identification.end(), is_claimed);
         });
}

// Returns the evidence that the pixels of a slot give in this pose.
Identifier::SlotEvidence Identifier::evidence_in_slot(const Scene& now, const Candidate& candidate,
                                                      const PoseEvidence& pose, std::size_t s) const {
  const MarkerLayout& layout = teams_[now.team].layout;
  const TeamColors& colors = team_colors_[now.team];
  const SlotColors& slot = colors.slots[s];
  const ColorId team_color = teams_[now.team].team_color;
  const ColorSpace space = color_space(now.frame.format);
  const float scale = now.patches.team[now.boxes[candidate.robot].team_patch].patch.scale_px_per_m;
  SlotEvidence out;
  out.region = pose.identification[s];
  const PatchCandidate* const region = out.region == kMissing ? nullptr : &now.patches.identification[out.region];
  const PixelPoint center = region != nullptr
                                ? region->center
                                : camera_.to_pixel(on_field(pose.pose, layout.patches[s + 1]), layout.height_m);
  SurfaceColor surface;
  if (!now.sample(center, step_px(colors, s + 1, scale), surface)) {
    out.likelihood.fill(ColorEvidence::kNoColor);
    out.of_team = ColorEvidence::kNoColor;
    return out;
  }
  out.likelihood = likelihoods(now, candidate.light, s, surface, region != nullptr ? region->color : kBackground);
  for (std::size_t i = 0; i < slot.colors.size(); ++i) {
    const bool in_box = region != nullptr && region->color == slot.colors[i];
    const float spread = *std::max_element(surface.spread.begin(), surface.spread.end());
    if (in_box && surface.saturated_channels() < 3 && spread < kUneven_levels) out.likelihood[i] += kBoxVote;
  }
  // If two channels are saturated, other colors look like the team color. The layout may also use the team color twice.
  const bool may_show_team_color = surface.saturated_channels() < 2 &&
                                   std::find(slot.colors.begin(), slot.colors.end(), team_color) == slot.colors.end();
  out.of_team = may_show_team_color ? out.likelihood[slot.colors.size()] : ColorEvidence::kNoColor;
  BorderColor border;
  if ((pose.partner != kMissing || is_uncertain({out.likelihood.data(), slot.colors.size()})) &&
      look_at_border(now, center, surface, s + 1, scale, &pose, border)) {
    for (std::size_t i = 0; i < slot.colors.size(); ++i) {
      out.likelihood[i] += colors_.log_likelihood_of_border(border, candidate.light, slot.colors[i], space);
    }
    if (may_show_team_color) {
      out.of_team += colors_.log_likelihood_of_border(border, candidate.light, team_color, space);
    }
  }
  out.depends_on_pose = border.rays >= kRaysOfTwoSides && border.rays < kMinBorderRays;
  if (candidate.has_floor) {
    out.floor = ColorEvidence::log_likelihood_of_same(surface, candidate.floor) - ColorEvidence::kNoColor;
  }
  return out;
}

// Returns false if the team patch cannot be sampled.
bool Identifier::evaluate(const Scene& now, Candidate& candidate) const {
  const TeamMarking& team = teams_[now.team];
  const TeamColors& colors = team_colors_[now.team];
  const BoxSighting& box = now.boxes[candidate.robot];
  if (!candidate.has_light) return false;
  // Several poses have the same region in a slot.
  std::array<FixedVector<SlotEvidence, kMaxPoses>, kMaxPatches - 1> known;
  for (PoseEvidence& pose : candidate.poses) {
    pose.floor = pose.costs = 0;
    pose.of_team = pose.prior;
    pose.value.fill(pose.prior);
    for (std::size_t s = 0; s + 1 < team.layout.patches.size(); ++s) {
      const std::uint16_t number = pose.identification[s];
      const bool may_be_known = number != kMissing && pose.partner == kMissing && !pose.is_merged;
      const auto* const same = std::find_if(known[s].begin(), known[s].end(),
                                            [&](const SlotEvidence& other) { return other.region == number; });
      const SlotEvidence evidence =
          may_be_known && same != known[s].end() ? *same : evidence_in_slot(now, candidate, pose, s);
      if (may_be_known && same == known[s].end() && !evidence.depends_on_pose) known[s].push_back(evidence);
      pose.floor += evidence.floor;
      pose.of_team += evidence.of_team;
      for (std::size_t r = 0; r < team.robots.size(); ++r) {
        pose.value[r] += evidence.likelihood[colors.slots[s].of_robot[r]];
      }
    }
  }
  // The right pose has the fewest patch positions that look like floor.
  float least_floor = std::numeric_limits<float>::max(), best_prior = -least_floor, of_team = -least_floor;
  for (const PoseEvidence& pose : candidate.poses) least_floor = std::min(least_floor, pose.floor);
  for (PoseEvidence& pose : candidate.poses) {
    for (std::size_t r = 0; r < team.robots.size(); ++r) {
      pose.value[r] -= pose.floor - least_floor;
      pose.best = r == 0 ? pose.value[r] : std::max(pose.best, pose.value[r]);
    }
    best_prior = std::max(best_prior, pose.prior + pose.search_doubt - (pose.floor - least_floor));
    of_team = std::max(of_team, pose.of_team - (pose.floor - least_floor));
  }
  candidate.unknown = best_prior + static_cast<float>(team.layout.patches.size() - 1) * ColorEvidence::kNoColor;
  if (box.is_tentative) candidate.unknown += kTentativeDoubt;
  candidate.unknown = std::max(candidate.unknown, of_team - kTeamColorDoubt);
  return !candidate.poses.empty() && (candidate.is_complete || !box.is_tentative);
}

// Returns the log likelihood of the best explanation of a candidate by a pose with other patches. A name that another
// robot has costs that robot its margin.
float Identifier::other_explanation(const Scene& now, std::size_t number, const PoseEvidence& pose,
                                    const AssignedIds& assigned) const {
  const Candidate& candidate = candidates_[number];
  std::array<float, kMaxRobotsPerTeam> cost{};
  for (std::size_t k = 0; k < assigned.size(); ++k) {
    if (k != number && assigned[k].robot != kNoRobot) {
      cost[static_cast<std::size_t>(assigned[k].robot)] = assigned[k].margin;
    }
  }
  float best = candidate.unknown;
  for (const PoseEvidence& other : candidate.poses) {
    if (similar(other.pose, pose.pose) || has_same_part(other, pose)) continue;
    for (std::size_t r = 0; r < teams_[now.team].robots.size(); ++r) best = std::max(best, other.value[r] - cost[r]);
  }
  return best;
}

// Returns whether both poses use the same identification regions, at least one of them.
bool Identifier::has_same_part(const PoseEvidence& a, const PoseEvidence& b) {
  return a.identification == b.identification && std::any_of(a.identification.begin(), a.identification.end(),
                                                             [](std::uint16_t number) { return number != kMissing; });
}

void Identifier::apply(const Scene& now, std::size_t number, const AssignedIds& all, std::span<bool> used,
                       Sightings& out) const {
  const TeamMarking& team = teams_[now.team];
  const Candidate& candidate = candidates_[number];
  const AssignedId& assigned = all[number];
  RobotSighting& robot = out.robots[candidate.robot];
  robot.id = kUnknownId;
  const RobotMarking* const name =
      assigned.robot == kNoRobot ? nullptr : &team.robots[static_cast<std::size_t>(assigned.robot)];
  // kNoIdentification is kept: poses were also searched around a team patch without identification patches.
  if (robot.doubt != IdDoubt::kNoIdentification) robot.doubt = IdDoubt::kSeveralPoses;
  const auto value = [&](const PoseEvidence& pose) {
    return name == nullptr ? pose.best : pose.value[static_cast<std::size_t>(assigned.robot)];
  };
  const PoseEvidence& best =
      *std::max_element(candidate.poses.begin(), candidate.poses.end(),
                        [&](const PoseEvidence& a, const PoseEvidence& b) { return value(a) < value(b); });
  if (!candidate.pose_is_sure) {
    if (value(best) < other_explanation(now, number, best, all) + kMinIdMargin) return;
    // If several poses use one visible part of a patch, only the heading is ambiguous.
    robot.has_heading = std::all_of(candidate.poses.begin(), candidate.poses.end(), [&](const PoseEvidence& other) {
      return similar(other.pose, best.pose) || value(best) >= value(other) + kMinIdMargin;
    });
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
  robot.doubt = name == nullptr ? IdDoubt::kUnknownColors : IdDoubt::kSeveralIds;
  if (name == nullptr || assigned.margin < kMinIdMargin) return;
  robot.doubt = IdDoubt::kNone;
  robot.id = name->id;
  robot.confidence = id_probability(assigned.margin);
}

// Returns the log likelihoods of the names of a robot, over all of its poses.
IdEvidence Identifier::evidence_of(const Scene& now, const Candidate& candidate) const {
  const TeamMarking& team = teams_[now.team];
  IdEvidence out;
  if (!candidate.has_evidence) {
    // The robot keeps its name, and no other robot may get it.
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

// Looks at all robots of a team, and names them together. They share `now.borders_left`.
void Identifier::name_team(const Scene& now, AssignedIds& assigned) {
  WorkBudget<int> borders(now.borders_left, robots_of(now.seen, now.team));
  candidates_.clear();
  for (std::size_t i = 0; i < now.seen.robots.size(); ++i) {
    if (index_of(now.seen.robots[i].team) != now.team || candidates_.full()) continue;
    candidates_.resize(candidates_.size() + 1);
    Candidate& candidate = candidates_.back();
    candidate.robot = i;
    now.borders_left = borders.take();
    collect_poses(now, candidate);
    candidate.has_evidence = evaluate(now, candidate);
    borders.give_back(now.borders_left);
  }
  WorkBudget<int> rest(borders.left(), candidates_.size());
  for (Candidate& candidate : candidates_) {
    now.borders_left = rest.take();
    if (has_only_claimed_regions(candidate)) {
      search_poses(now, candidate);
      candidate.has_evidence = evaluate(now, candidate);
    }
    rest.give_back(now.borders_left);
  }
  now.borders_left = rest.left();
  share_patches(now);
  IdEvidences evidence;
  for (const Candidate& candidate : candidates_) evidence.push_back(evidence_of(now, candidate));
  assign_ids(evidence, teams_[now.team].robots.size(), kClearMargin, assigned);
  compare_robots(now, evidence, assigned);
}

bool Identifier::has_doubt(const AssignedIds& assigned) const {
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    if (candidates_[k].has_evidence && (assigned[k].robot == kNoRobot || assigned[k].margin < kMinIdMargin)) {
      return true;
    }
  }
  return false;
}

void Identifier::identify(const Frame& frame, const ExpectedGain& light, const PatchLists& patches,
                          std::span<const Hypothesis> hypotheses, std::span<const BoxSighting> boxes, bool is_clutter,
                          std::span<bool> used, Sightings& out) {
  std::size_t robots = 0;
  for (std::size_t t = 0; t < teams_.size(); ++t) robots += team_colors_[t].usable ? robots_of(out, t) : 0;
  WorkBudget<int> borders(kMaxBorders, robots);
  ExpectedColors expected;
  int clipped_from = 0;  // 0: the frame was not examined yet
  for (std::size_t t = 0; t < teams_.size(); ++t) {
    if (!team_colors_[t].usable) continue;
    int borders_left = borders.take(robots_of(out, t));
    Scene now{frame, light, patches, hypotheses, boxes, out, t, borders_left, expected};
    AssignedIds assigned;
    name_team(now, assigned);
    if (!is_clutter && has_doubt(assigned)) {
      if (clipped_from == 0) clipped_from = saturated_from(frame);
      if (clipped_from < kSaturatedValue) {
        now.saturated_from = clipped_from;
        name_team(now, assigned);
      }
    }
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (candidates_[k].has_evidence) apply(now, k, assigned, used, out);
    }
    borders.give_back(borders_left);
  }
}

}  // namespace touchline
