#include "core/subpixel/missed_robots.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/marker/color_errors.h"
#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"
#include "core/subpixel/paint_colors.h"

namespace touchline {
namespace {

// Robots whose centers are closer are the same robot: two of them cannot be closer than their side.
constexpr float kSamePlace = 0.75f;

bool is_at(const RobotSighting& robot, FieldPoint place, float side_m) {
  return distance_m(robot.pose.position, place) < kSamePlace * side_m;
}

}  // namespace

float MissedRobots::likelihood_of(const SurfaceColor& paint, const LocalLight& light, ColorId color,
                                  ColorSpace space) const {
  ExpectedColors4 expected;
  for (std::size_t lane = 0; lane < 4; ++lane) expected.set(lane, colors_.expected_color(light, color, space));
  return ColorEvidence::log_likelihoods(paint, expected, light.glare, Simd4<std::int32_t>{})[0];
}

// All robots of the team have the team color, so its likelihood counts against the other team and no team.
MissedRobots::Name MissedRobots::name_of(const Frame& frame, const ExpectedGain& light, Team of, const SeenTop& top,
                                         const std::array<float, 3>& usual_top) const {
  const TeamMarking& team = teams_[index_of(of)];
  const ColorId other_color = teams_[1 - index_of(of)].team_color;
  const ColorSpace space = color_space(frame.format);
  PaintColors paints;
  if (!see_paints(frame, camera_, team.layout, top.pose, usual_top, paints)) return {};
  const LightPrior prior = expected_light(light, top.patches[0]);
  const LocalLight around = light_around(prior), on_robot = colors_.light_on(paints[0], team.team_color, space, prior);
  const float of_team = likelihood_of(paints[0], around, team.team_color, space);
  const bool has_other = other_color != kBackground && colors_.knows(other_color);
  const float of_other = has_other ? likelihood_of(paints[0], around, other_color, space) : ColorEvidence::kFloor;
  Name best;
  float best_value = std::numeric_limits<float>::lowest(), second = best_value;
  for (std::size_t r = 0; r < team.robots.size(); ++r) {
    float value = 0;
    for (std::size_t k = 1; k < paints.size(); ++k) {
      value += likelihood_of(paints[k], on_robot, team.robots[r].colors[k - 1], space);
    }
    second = std::max(second, std::min(value, best_value));
    if (value > best_value) {
      best_value = value;
      best.robot = r;
    }
  }
  const float no_robot = static_cast<float>(paints.size()) * ColorEvidence::kNoColor;
  best.margin = std::min({best_value - second, of_team - of_other, of_team + best_value - no_robot});
  return best;
}

void MissedRobots::find(const Frame& frame, const ExpectedGain& light, const ExpectedRobots& expected, TopFit& fit,
                        Sightings& out) const {
  SeenTop top;
  for (const ExpectedRobot& robot : expected) {
    const TeamMarking& team = teams_[index_of(robot.team)];
    const float side_m = team.layout.robot_side_m;
    if (team.team_color == kBackground || team.robots.empty() || !colors_.knows(team.team_color)) continue;
    const auto is_named = [](const RobotSighting& seen) { return seen.id != kUnknownId; };
    const auto is_taken = [&](FieldPoint place) {
      return std::any_of(out.robots.begin(), out.robots.end(),
                         [&](const RobotSighting& seen) { return is_named(seen) && is_at(seen, place, side_m); });
    };
    const auto is_seen = [&](RobotId id) {
      return std::any_of(out.robots.begin(), out.robots.end(),
                         [&](const RobotSighting& seen) { return seen.team == robot.team && seen.id == id; });
    };
    if (is_seen(robot.id) || is_taken(robot.pose.position)) continue;
    if (!fit.look(frame, robot.team, robot.pose, top) || is_taken(top.pose.position)) continue;
    const Name name = name_of(frame, light, robot.team, top, fit.usual_top());
    const RobotId id = team.robots[name.robot].id;
    if (name.margin < kMinIdMargin || is_seen(id)) continue;
    RobotSighting found;
    found.team = robot.team;
    found.id = id;
    found.has_heading = true;
    found.pose = top.pose;
    found.residual_m = top.residual_m;
    found.noise = top.noise;
    found.lasting_share = top.lasting_share;
    found.lasts_m = top.lasts_m;
    // The adaptation must not learn from these patches, which it recognizes by their roles.
    found.patches.push_back({PatchRole::kTeam, 0, team.team_color, top.patches[0]});
    found.confidence = id_probability(name.margin);
    const auto old = std::find_if(out.robots.begin(), out.robots.end(), [&](const RobotSighting& seen) {
      return seen.team == robot.team && is_at(seen, top.pose.position, side_m);
    });
    if (old != out.robots.end()) {
      *old = found;
    } else {
      out.robots.push_back(found);
    }
  }
}

}  // namespace touchline
