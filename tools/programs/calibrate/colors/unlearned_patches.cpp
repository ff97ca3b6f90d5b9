#include "tools/programs/calibrate/colors/unlearned_patches.h"

#include <algorithm>
#include <cmath>

namespace touchline::calibrate {
namespace {

// Largest dissimilarity at which a patch may have a color in other light.
constexpr double kSimilarColor = 25.0;

// Returns whether a patch may have a color in other light.
bool may_have(const DetectedColors& out, std::size_t color, const FoundPatch& patch) {
  const AssignedColor& assigned = out.assignment.colors[color];
  return !assigned.patches.empty() && is_plausible(out.input.colors[color].look, patch.rgb) &&
         dissimilarity(patch.lab, lab_of(assigned.rgb)) < kSimilarColor;
}

// Returns whether all robots of a team are recognized in the patch's picture, and the patch is on none of them.
bool is_apart_from_all_robots(const DetectedColors& out, std::size_t team, std::size_t patch,
                              const CameraModel& camera) {
  const TeamMarking& marking = out.input.teams[team];
  const MarkerLayout& layout = marking.layout;
  const FieldPoint at = camera.to_field(out.input.patches[patch].center, layout.height_m);
  const auto is_here = [&](const AssignedRobot& robot) {
    return robot.team == team && robot.picture == out.input.picture[patch];
  };
  const auto is_on = [&](const AssignedRobot& robot) {
    if (!is_here(robot)) return false;
    const FieldPoint there = camera.to_field(out.input.patches[robot.team_patch].center, layout.height_m);
    return std::hypot(there.x_m - at.x_m, there.y_m - at.y_m) < layout.robot_side_m;
  };
  const std::vector<AssignedRobot>& named = out.assignment.named;
  const std::vector<AssignedRobot>& unlisted = out.assignment.unlisted;
  const bool is_on_robot =
      std::any_of(named.begin(), named.end(), is_on) || std::any_of(unlisted.begin(), unlisted.end(), is_on);
  if (is_on_robot) return false;
  // Each robot is named at most once in a picture.
  const auto recognized = static_cast<std::size_t>(std::count_if(named.begin(), named.end(), is_here));
  return !marking.robots.empty() && recognized == marking.robots.size();
}

}  // namespace

void find_things(const CameraModel& camera, DetectedColors& out) {
  for (std::size_t t = 0; t < out.input.teams.size(); ++t) {
    const ColorId id = out.input.teams[t].team_color;
    if (id == kBackground) continue;
    for (std::size_t p = 0; p < out.input.patches.size(); ++p) {
      const FoundPatch& patch = out.input.patches[p];
      if (!may_have(out, id - 1U, patch) || !is_apart_from_all_robots(out, t, p, camera)) continue;
      std::vector<std::size_t>& things = out.things[out.images[out.input.picture[p]]];
      things.insert(things.end(), patch.pixels.begin(), patch.pixels.end());
    }
  }
}

void leave_out_similar(DetectedColors& out) {
  for (std::size_t p = 0; p < out.input.patches.size(); ++p) {
    const FoundPatch& patch = out.input.patches[p];
    bool similar = false;
    for (std::size_t c = 0; c < out.input.colors.size(); ++c) similar = similar || may_have(out, c, patch);
    if (!similar) continue;
    std::vector<std::size_t>& unclear = out.unclear[out.images[out.input.picture[p]]];
    unclear.insert(unclear.end(), patch.pixels.begin(), patch.pixels.end());
  }
}

}  // namespace touchline::calibrate
