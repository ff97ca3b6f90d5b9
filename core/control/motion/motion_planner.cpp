#include "core/control/motion/motion_planner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/control/motion/drive_limits.h"
#include "core/control/motion/speed_profile.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

// Directions of the first part of a detour from the direction of the goal, and its lengths.
constexpr std::array<double, 8> kTurns{0.4, -0.4, 0.8, -0.8, 1.3, -1.3, 2.0, -2.0};
constexpr std::array<double, 2> kLengths_m{0.18, 0.40};
// Another trajectory must be faster than last frame's by this time, so that a robot does not oscillate between two.
// With 0.25 s, robots reach 5 % fewer goals.
constexpr double kHysteresis_s = 0.12;
// A conflict at once costs this time, one at the end of the prediction nothing: somebody will move until then. With 1.5
// s, robots touch a third more often, and strict ones wait for each other forever; with 4 s, they drive longer ways.
constexpr double kConflict_s = 2.5;
// Number of steps (1 s; more for slow robots) after which a conflict starts no search for a detour, because the others
// will have moved by then.
constexpr std::size_t kSearchesBefore = 10;
// Other robots keep their velocity this long; then they have decided something else.
constexpr double kKeepsVelocity_s = 0.5;
// Robots slower than this stand: they are walls for everybody.
constexpr double kStands_mps = 0.05;
// Strict: distance of two robots' circles that is never used up: twice the prediction's error and a lost packet's way.
constexpr double kStrictMargin_m = 0.008;
constexpr double kLongestPeriod_s = 0.05, kShortestPeriod_s = 0.004;

double distance_to_way(Vector2 p, Vector2 from, Vector2 to) {
  const Vector2 way = to - from;
  const double length2 = dot(way, way);
  const double part = length2 > 0.0 ? std::clamp(dot(p - from, way) / length2, 0.0, 1.0) : 0.0;
  return distance(p, from + part * way);
}

}  // namespace

void MotionPlanner::configure(const ControlParameters& parameters, const FieldParameters& field) {
  parameters_ = parameters;
  limits_ = MotionLimits(parameters.drive);
  const double margin = parameters.play.robot_radius_m;
  area_ = {0.5 * static_cast<double>(field.length_m) - margin, 0.5 * static_cast<double>(field.width_m) - margin};
  // Slow robots look as far as fast ones do: at least 0.6 m.
  step_s_ = std::max(0.1, 0.6 / limits_.speed_mps / static_cast<double>(PredictedPath::kSteps));
}

void MotionPlanner::reset() {
  memory_.clear();
  robots_.clear();
  begun_ = false;
}

void MotionPlanner::begin(const Tracks& tracks) {
  if (begun_) {
    period_s_ = std::clamp(seconds(tracks.capture_time - last_time_), kShortestPeriod_s, kLongestPeriod_s);
  }
  begun_ = true;
  last_time_ = tracks.capture_time;
  robots_.clear();
  for (const RobotTrack& track : tracks.robots) {
    Robot robot{track.team,
                track.id,
                motion_state(track.pose_at_action, track.twist_at_action, track.twist_at_action),
                {},
                false};
    robot.path = constant_velocity(robot.state.place, robot.state.v_mps * unit_vector(robot.state.heading_rad),
                                   kKeepsVelocity_s, step_s_);
    robots_.push_back(robot);
  }
  // Robots that left the field leave the memory, too.
  std::size_t kept = 0;
  for (const Memory& memory : memory_) {
    if (memory.used) memory_[kept++] = memory;
  }
  memory_.resize(kept);
  for (Memory& memory : memory_) memory.used = false;
}

MotionPlanner::Memory& MotionPlanner::memory_of(RobotId id) {
  for (Memory& memory : memory_) {
    if (memory.id == id) return memory;
  }
  if (memory_.full()) memory_.resize(memory_.size() - 1);
  Memory fresh;
  fresh.id = id;
  memory_.push_back(fresh);
  return memory_.back();
}

void MotionPlanner::list_obstacles(const Robot& robot, const MotionGoal& goal) {
  const bool is_strict = parameters_.avoid == Avoidance::kStrict;
  const double diagonal = 2.0 * std::numbers::sqrt2 * parameters_.play.robot_radius_m;
  const double clearance = is_strict ? std::max(parameters_.play.clearance_m, diagonal + 3.0 * kStrictMargin_m)
                                     : parameters_.play.clearance_m;
  const double reach = limits_.speed_mps * step_s_ * static_cast<double>(PredictedPath::kSteps);
  // The robot itself may be faster than its limit.
  const double own_mps = std::max(limits_.speed_mps, std::abs(robot.state.v_mps));
  const auto step_m = [&](double speed) { return 1.01 * step_s_ * (own_mps + std::abs(speed)); };
  obstacles_.clear();
  for (const Robot& other : robots_) {
    if (&other == &robot) continue;
    const Vector2 apart = other.state.place - robot.state.place;
    const double others_reach = std::abs(other.state.v_mps) * kKeepsVelocity_s;
    if (std::max(std::abs(apart.x), std::abs(apart.y)) > reach + others_reach + clearance) continue;
    // Who fights for a ball touches opponents.
    if (other.team != Team::kOwn && goal.end_speed_mps > 0.0 && distance(other.state.place, goal.place) < clearance)
      continue;
    PathObstacle obstacle{&other.path, clearance, step_m(other.is_planned ? limits_.speed_mps : other.state.v_mps),
                          PredictedPath::kSteps};
    // Own robots with a lower priority that move give way, as soon as they can.
    const bool gives_way =
        other.team == Team::kOwn && other.id >= 0 && !other.is_planned && std::abs(other.state.v_mps) > kStands_mps;
    if (gives_way && !is_strict) obstacle.steps = 3;
    obstacles_.push_back(obstacle);
  }
  // The nearest obstacles decide most candidates.
  const auto away = [&](const PathObstacle& obstacle) {
    const Vector2 apart = obstacle.path->at[0] - robot.state.place;
    return dot(apart, apart);
  };
  std::sort(obstacles_.begin(), obstacles_.end(),
            [&](const PathObstacle& a, const PathObstacle& b) { return away(a) < away(b); });
}

void MotionPlanner::consider(const PathStart& robot, const MotionGoal& goal, Vector2 via, double bonus_s,
                             Choice& best) const {
  const Vector2 first = via - robot.place;
  const double first_m = norm(first);
  double cost = (first_m + distance(via, goal.place)) / limits_.speed_mps - bonus_s;
  if (cost >= best.cost) return;
  const double turning_s = turning_time(robot, first, limits_);
  cost += turning_s;
  if (cost >= best.cost) return;
  const PredictedPath path = along(robot, via, goal.place, turning_s, step_s_, limits_);
  constexpr double kSteps = static_cast<double>(PredictedPath::kSteps);
  // With an earlier conflict, the candidate cannot be the best one.
  const double least = 1.0 + kSteps * (1.0 - (best.cost - cost) / kConflict_s);
  const std::size_t conflict = first_conflict(path, obstacles_, least > 0.0 ? static_cast<std::size_t>(least) : 0);
  if (conflict <= PredictedPath::kSteps) cost += kConflict_s * (1.0 - (static_cast<double>(conflict) - 1.0) / kSteps);
  if (cost >= best.cost) return;
  best = {via, cost, conflict, false, path};
}

MotionPlanner::Choice MotionPlanner::choose(const MotionState& state, const MotionGoal& goal, Memory& memory) const {
  const PathStart robot(state);
  Choice best;
  const bool is_same_goal = memory.known && distance(memory.goal, goal.place) < 0.05;
  const bool had_detour = is_same_goal && distance(memory.via, memory.goal) > 1e-6;
  // Last frame's detour first, until its point is reached.
  if (had_detour && distance(memory.via, robot.place) > 0.03) consider(robot, goal, memory.via, kHysteresis_s, best);
  consider(robot, goal, goal.place, had_detour ? 0.0 : kHysteresis_s, best);
  if (best.conflict <= kSearchesBefore) {
    const double ahead = bearing(goal.place - robot.place);
    for (const double turn : kTurns) {
      const Vector2 direction = unit_vector(ahead + turn);
      for (const double length : kLengths_m) {
        const Vector2 via = robot.place + length * direction;
        if (area_.contains(via)) consider(robot, goal, via, 0.0, best);
      }
    }
  }
  return best;
}

// A robot may move if, after the next period, it can brake without coming nearer to another robot's braking way than
// the margin allows, or if it moves away from it. Since each robot's last decision left room for braking, braking is
// always possible.
bool MotionPlanner::may_move(const Robot& robot, const Twist& command) const {
  const double a = limits_.acceleration_mps2;
  // A lost packet lets a robot go on for another period.
  const auto way_to_stop = [&](double v) { return v * (2.0 * period_s_ + 0.5 * std::abs(v) / a); };
  const Twist wheels = wheels_after(robot.state.wheels, command, period_s_, parameters_.drive);
  const double v = std::max(std::abs(static_cast<double>(wheels.v_mps)), std::abs(robot.state.v_mps));
  const double sign = static_cast<double>(wheels.v_mps) < 0.0 ? -1.0 : 1.0;
  const Vector2 ahead = unit_vector(robot.state.heading_rad);
  const Vector2 end = robot.state.place + way_to_stop(sign * v) * ahead;
  const double least = 2.0 * std::numbers::sqrt2 * parameters_.play.robot_radius_m + kStrictMargin_m;
  return std::none_of(robots_.begin(), robots_.end(), [&](const Robot& other) {
    if (&other == &robot) return false;
    const double now = distance(robot.state.place, other.state.place);
    const Vector2 others_end =
        other.state.place + way_to_stop(other.state.v_mps) * unit_vector(other.state.heading_rad);
    // Unless two ways cross, their least distance is at an end of one of them.
    const double after = std::min({distance_to_way(end, other.state.place, others_end),
                                   distance_to_way(robot.state.place, other.state.place, others_end),
                                   distance_to_way(other.state.place, robot.state.place, end),
                                   distance_to_way(others_end, robot.state.place, end)});
    return after < std::min(least, now) && distance(end, others_end) < distance(robot.state.place, others_end);
  });
}

MotionPlanner::Robot* MotionPlanner::find(RobotId id) {
  auto* const found = std::find_if(robots_.begin(), robots_.end(),
                                   [&](const Robot& robot) { return robot.team == Team::kOwn && robot.id == id; });
  return found == robots_.end() ? nullptr : found;
}

bool MotionPlanner::permits(RobotId id, const MotionState& state, const Twist& command) {
  Robot* const robot = find(id);
  if (parameters_.avoid != Avoidance::kStrict || robot == nullptr) return true;
  robot->state = state;
  if (may_move(*robot, command)) return true;
  robot->path = stopping(state, step_s_, limits_);
  return false;
}

Twist MotionPlanner::drive(RobotId id, const MotionState& state, const MotionGoal& goal) {
  Robot* const found = find(id);
  if (found == nullptr) return touchline::drive(state, goal, period_s_, parameters_.drive, area_);
  Robot& robot = *found;
  robot.state = state;
  Memory& memory = memory_of(id);
  list_obstacles(robot, goal);
  Choice choice;
  const bool is_free = obstacles_.empty();
  if (is_free) {
    choice.via = goal.place;
    const PathStart start(state);
    const double turning_s = turning_time(start, goal.place - start.place, limits_);
    choice.path = along(start, goal.place, goal.place, turning_s, step_s_, limits_);
  } else {
    choice = choose(state, goal, memory);
  }
  // Brake if the conflict comes before the robot could stop, one step later.
  const double stops_s = std::abs(state.v_mps) / limits_.acceleration_mps2;
  choice.brakes = !is_free && choice.conflict <= PredictedPath::kSteps &&
                  static_cast<double>(choice.conflict) - 1.0 <= std::ceil(stops_s / step_s_);
  MotionGoal next = goal;
  const bool is_direct = distance(choice.via, goal.place) < 1e-9;
  if (!is_direct) {
    next = {};
    next.place = choice.via;
    next.end_speed_mps = limits_.speed_mps;
  }
  robot.path = choice.brakes ? stopping(state, step_s_, limits_) : choice.path;
  robot.is_planned = true;
  memory.via = choice.via;
  memory.goal = goal.place;
  memory.used = memory.known = true;
  return choice.brakes ? brake(state, period_s_, parameters_.drive)
                       : touchline::drive(state, next, period_s_, parameters_.drive, area_);
}

}  // namespace touchline
