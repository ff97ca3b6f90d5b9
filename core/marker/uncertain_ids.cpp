// Parts of Matcher for robots whose ids or confidence depend on the shape that pixels show.
#include <algorithm>
#include <array>

#include "core/marker/matcher.h"
#include "core/marker/rigid_fit.h"
#include "core/marker/unknown_robot.h"

namespace touchline {
namespace {

// An id that is based only on colors needs at least this probability that the object is a robot.
constexpr float kMinConfidenceForId = 0.5f;

}  // namespace

// Returns whether the robot was found by a region from which an overload removed runs.
bool Matcher::is_cut(const RobotSighting& robot, const BoxSighting& box, const Regions& regions) const {
  if (regions[team_patches_[box.team_patch].patch.region].is_cut) return true;
  return std::any_of(robot.patches.begin(), robot.patches.end(), [&](const PatchSighting& seen) {
    return std::any_of(identification_.begin(), identification_.end(), [&](const PatchCandidate& patch) {
      return patch.color == seen.color && patch.center.u_px == seen.center.u_px &&
             patch.center.v_px == seen.center.v_px && regions[patch.region].is_cut;
    });
  });
}

// Removes ids that are based on cut regions, unless the pixels confirm the robot. (The rest of a larger region may look
// like a patch, but pixels are complete.)
void Matcher::doubt_cut_patches(const Frame* frame, const Regions& regions, Sightings& out) {
  if (std::none_of(regions.begin(), regions.end(), [](const Region& region) { return region.is_cut; })) return;
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    RobotSighting& robot = out.robots[i];
    if (robot.id == kUnknownId || !is_cut(robot, box_sightings_[i], regions)) continue;
    const MarkerLayout& layout = parameters_.teams[index_of(robot.team)].layout;
    if (frame != nullptr && robot.has_heading && has_all_outlines(*frame, finder_.camera(), layout, robot)) continue;
    robot.id = kUnknownId;
    robot.doubt = IdDoubt::kOverload;
  }
}

// Sets the confidence of robots without an id, and drops unlikely ones. First removes two kinds of ids unless the
// pixels confirm them. An id that only pixels gave needs the outline of the team patch if the patch was split off a
// larger region. An id without a heading needs the shape of a robot.
void Matcher::weigh_unknown_id(const Frame& frame, Sightings& out) {
  std::array<bool, kMaxRobots> has_stripes{};
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const RobotSighting &a = out.robots[i], &b = out.robots[j];
      if (a.team != b.team || a.id != kUnknownId || b.id != kUnknownId) continue;
      if (distance_m(a.pose.position, b.pose.position) >= parameters_.teams[index_of(a.team)].layout.robot_side_m)
        continue;
      has_stripes[i] = has_stripes[j] = true;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    RobotSighting& robot = out.robots[i];
    const BoxSighting box = box_sightings_[i];
    const PatchCandidate& patch = team_patches_[box.team_patch].patch;
    const MarkerLayout& layout = parameters_.teams[index_of(robot.team)].layout;
    const CameraModel& camera = finder_.camera();
    if (patch.is_split_part && robot.patches.size() == 1 && robot.has_heading &&
        !has_team_outline(frame, camera, layout, robot)) {
      robot.id = kUnknownId;
      robot.doubt = IdDoubt::kOtherOutline;
    }
    // Without a heading, no pose of the layout explained the pixels, so the id is based only on colors.
    if (robot.id != kUnknownId && !robot.has_heading) {
      RobotSighting of_patch = robot;
      of_patch.pose.position = patch.at[index_of(robot.team)];
      const float is_robot = likely_robot(frame, camera, layout, of_patch, patch.ratio, has_stripes[i]).probability;
      robot.confidence = std::min(robot.confidence, is_robot);
      if (is_robot < kMinConfidenceForId) {
        robot.id = kUnknownId;
        robot.doubt = IdDoubt::kOtherOutline;
      }
    }
    if (robot.id == kUnknownId) {
      const LikelyRobot likely = likely_robot(frame, camera, layout, robot, patch.ratio, has_stripes[i]);
      robot.confidence = likely.probability;
      robot.pose.theta_rad = likely.heading_rad;
    }
    if (robot.confidence < kMinUnknownIdProbability) {
      reported_[box.team_patch] = false;
      out.verdicts[patch.region] = Verdict::kNoPartner;
    } else {
      box_sightings_[kept] = box;
      out.robots[kept++] = robot;
    }
  }
  out.robots.resize(kept);
  box_sightings_.resize(kept);
}

}  // namespace touchline
