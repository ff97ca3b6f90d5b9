#include "core/subpixel/missed_robots.h"

#include <algorithm>

#include "core/marker/clipping_level.h"
#include "core/marker/hypothesis.h"
#include "core/marker/identifier_scene.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// Two centers that are closer than this part of a robot's side belong to one robot: those of two robots are at least a
// side apart, and a robot without a heading is reported at its team patch, at most half a diagonal from its center.
constexpr float kSamePlace = 0.75f;
// Least weight of a fit. Below it, more than half of a recognized robot's pose would be that of the start, and here the
// start is only a prediction.
constexpr float kMinTrust = 0.5f;

bool is_at(const RobotSighting& robot, FieldPoint place, float side_m) {
  return distance_m(robot.pose.position, place) < kSamePlace * side_m;
}

// Returns whether pixels said no more about a robot without an id than that its patches have not the usual colors.
bool is_replaceable(const RobotSighting& robot) {
  return robot.id == kUnknownId && (robot.doubt == IdDoubt::kNone || robot.doubt == IdDoubt::kNoIdentification ||
                                    robot.doubt == IdDoubt::kUnknownColors);
}

bool is_in(const Frame& frame, PixelPoint point) {
  return point.u_px >= 0.0f && point.v_px >= 0.0f && point.u_px < static_cast<float>(frame.width_px) &&
         point.v_px < static_cast<float>(frame.height_px);
}

template <class Condition>
void erase_if(FixedVector<RobotSighting, kMaxRobots>& robots, Condition condition) {
  robots.resize(static_cast<std::size_t>(std::remove_if(robots.begin(), robots.end(), condition) - robots.begin()));
}

}  // namespace

float MissedRobots::likelihood_of(const SurfaceColor& paint, const LocalLight& light, ColorId color,
                                  ColorSpace space) const {
  const ExpectedColor one = colors_.expected_color(light, color, space);
  ExpectedColors4 expected;
  for (std::size_t lane = 0; lane < 4; ++lane) expected.set(lane, one);
  return ColorEvidence::log_likelihoods(paint, expected, light.glare, Simd4<std::int32_t>{})[0];
}

bool MissedRobots::is_free(FieldPoint place, float side_m, const Sightings& seen, const Tops& tops) const {
  return inside_field(field_, place) &&
         std::none_of(
             seen.robots.begin(), seen.robots.end(),
             [&](const RobotSighting& robot) { return !is_replaceable(robot) && is_at(robot, place, side_m); }) &&
         std::none_of(tops.begin(), tops.end(),
                      [&](const SeenTop& top) { return distance_m(top.pose.position, place) < kSamePlace * side_m; });
}

// Other explanations count as unknown: no robot, a robot with other colors, one of the other team, and one whose id was
// given to another robot.
IdEvidence MissedRobots::evidence_of(const PaintColors& paints, const LightPrior& prior, Team of, ColorSpace space,
                                     const Sightings& seen) const {
  const TeamMarking& team = teams_[index_of(of)];
  const ColorId other = teams_[1 - index_of(of)].team_color;
  const LocalLight around = light_around(prior), on_robot = colors_.light_on(paints[0], team.team_color, space, prior);
  const float of_team = likelihood_of(paints[0], around, team.team_color, space);
  const bool has_other = other != kBackground && colors_.knows(other);
  const float of_other = has_other ? likelihood_of(paints[0], around, other, space) : ColorEvidence::kFloor;
  IdEvidence out;
  const float no_names = static_cast<float>(paints.size() - 1) * ColorEvidence::kNoColor;
  out.unknown = no_names + std::max(of_team, ColorEvidence::kNoColor);
  const float impossible = 2.0f * static_cast<float>(paints.size()) * ColorEvidence::kFloor;
  for (std::size_t r = 0; r < team.robots.size(); ++r) {
    float patches = 0;
    for (std::size_t k = 1; k < paints.size(); ++k) {
      patches += likelihood_of(paints[k], on_robot, team.robots[r].colors[k - 1], space);
    }
    out.value[r] = of_team + patches;
    out.unknown = std::max(out.unknown, of_other + patches);
    const bool is_seen = std::any_of(seen.robots.begin(), seen.robots.end(), [&](const RobotSighting& robot) {
      return robot.team == of && robot.id == team.robots[r].id;
    });
    if (!is_seen) continue;
    out.unknown = std::max(out.unknown, out.value[r]);
    out.value[r] = impossible;
  }
  return out;
}

void MissedRobots::look(const Frame& frame, const ExpectedGain& light, const ExpectedRobots& expected, Team of,
                        TopFit& fit, const Sightings& seen, Tops& tops, IdEvidences& evidence) const {
  const TeamMarking& team = teams_[index_of(of)];
  const float side_m = team.layout.robot_side_m;
  int clipped_from = 0;
  for (const ExpectedRobot& robot : expected) {
    if (robot.team != of || tops.full()) continue;
    const bool is_seen = std::any_of(seen.robots.begin(), seen.robots.end(), [&](const RobotSighting& other) {
      return other.team == of && other.id == robot.id;
    });
    if (is_seen || !is_free(robot.pose.position, side_m, seen, tops)) continue;
    SeenTop top;
    if (!fit.look(frame, of, robot.pose, top) || top.trust < kMinTrust || !top.is_precise) continue;
    const bool is_whole = std::all_of(top.patches.begin(), top.patches.end(),
                                      [&](const PixelPoint& center) { return is_in(frame, center); });
    if (!is_whole || !is_free(top.pose.position, side_m, seen, tops)) continue;
    if (clipped_from == 0) clipped_from = saturated_from(frame);
    PaintColors paints;
    if (!see_paints(frame, camera_, team.layout, top.pose, fit.usual_top(of), clipped_from, paints)) continue;
    tops.push_back(top);
    const LightPrior prior = expected_light(light, top.patches[0]);
    evidence.push_back(evidence_of(paints, prior, of, color_space(frame.format), seen));
  }
}

void MissedRobots::report(const SeenTop& top, Team of, RobotId id, float margin, Sightings& out) const {
  const TeamMarking& team = teams_[index_of(of)];
  const auto is_replaced = [&](const RobotSighting& robot) {
    return robot.id == kUnknownId && is_at(robot, top.pose.position, team.layout.robot_side_m);
  };
  const auto others = std::count_if(out.robots.begin(), out.robots.end(), [&](const RobotSighting& robot) {
    return robot.team == of && !is_replaced(robot);
  });
  if (others >= team.max_robots) return;
  erase_if(out.robots, is_replaced);
  RobotSighting robot;
  robot.team = of;
  robot.id = id;
  robot.is_by_track = true;
  robot.has_heading = true;
  robot.pose = top.pose;
  robot.residual_m = top.residual_m;
  robot.noise = top.noise;
  robot.lasting_share = top.lasting_share;
  robot.lasts_m = top.lasts_m;
  robot.confidence = id_probability(margin);
  // Without an identification patch, the adaptation learns nothing from this robot.
  robot.patches.push_back({PatchRole::kTeam, 0, team.team_color, top.patches[0]});
  out.robots.push_back(robot);
}

void MissedRobots::find(const Frame& frame, const ExpectedGain& light, const ExpectedRobots& expected, TopFit& fit,
                        Sightings& out) const {
  for (const Team of : {Team::kOwn, Team::kOpponent}) {
    const TeamMarking& team = teams_[index_of(of)];
    if (!colors_.can_name(team)) continue;
    Tops tops;
    IdEvidences evidence;
    look(frame, light, expected, of, fit, out, tops, evidence);
    if (tops.empty()) continue;
    AssignedIds names;
    assign_ids(evidence, team.robots.size(), kClearMargin, names);
    for (std::size_t i = 0; i < tops.size(); ++i) {
      if (names[i].robot == kNoRobot || names[i].margin < kMinIdMargin) continue;
      report(tops[i], of, team.robots[static_cast<std::size_t>(names[i].robot)].id, names[i].margin, out);
    }
  }
}

}  // namespace touchline
