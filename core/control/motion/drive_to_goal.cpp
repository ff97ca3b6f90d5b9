#include "core/control/motion/drive_to_goal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/control/motion/drive_limits.h"
#include "core/control/motion/drive_through.h"
#include "core/control/motion/speed_profile.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr double kPi = std::numbers::pi;
// A robot that stops this near to its goal turns to the final heading. Below, the bearing of the goal is mostly noise
// of the track (0.3 mm) and of the drive.
constexpr double kAtPlace_m = 0.0022, kMovesPerTurn_m = 0.003;
// On the line through the goal, it may be this far away: driving along the final heading corrects the rest.
constexpr double kAlongLine_m = 0.02;
// Periods in which small errors of the heading are closed: of a robot that turns in place, and of one that drives with
// kFast_mps or more. On the way, random slip changes the heading by 0.03 rad; a law that answers faster takes the
// wheels' acceleration from braking.
constexpr double kPeriodsAtPlace = 2.0, kPeriodsOnWay = 4.5, kFast_mps = 0.6;
// Speed below which a robot near its goal counts as stopping.
constexpr double kSlow_mps = 0.15;

bool is_finite(const MotionState& robot, const MotionGoal& goal) {
  return std::isfinite(robot.place.x) && std::isfinite(robot.place.y) && std::isfinite(robot.heading_rad) &&
         std::isfinite(robot.v_mps) && std::isfinite(robot.w_radps) && std::isfinite(goal.place.x) &&
         std::isfinite(goal.place.y) && std::isfinite(goal.end_speed_mps) &&
         std::isfinite(goal.direction_rad.value_or(0.0));
}

// Velocities of the wheels after the period.
struct Velocities {
  double v_mps = 0.0, w_radps = 0.0;
};

// The wheels' acceleration is shared: turning goes first. Braking for a stop keeps what plans use, because a robot that
// turns instead of braking drives past its goal. Everything else keeps a tenth.
Velocities shared(const MotionState& robot, Velocities wanted, double period_s, const MotionLimits& limits) {
  const double budget = limits.wheel_acceleration_mps2 * period_s;
  const double dv = wanted.v_mps - robot.v_mps, dw = wanted.w_radps - robot.w_radps;
  const bool brakes = dv * robot.v_mps < 0.0;
  const double kept = std::min(std::abs(dv), (brakes ? 0.9 : 0.1) * budget);
  const double turn = std::min(std::abs(dw) * limits.half_base_m, budget - kept);
  const double drive = std::min(std::abs(dv), budget - turn);
  return {robot.v_mps + std::copysign(drive, dv), robot.w_radps + std::copysign(turn, dw) / limits.half_base_m};
}

Twist command_of(const MotionState& robot, Velocities wanted, double period_s, const DriveParameters& drive) {
  return command_to_change(robot, wanted.v_mps - robot.v_mps, wanted.w_radps - robot.w_radps, period_s, drive);
}

// The turn to the heading at the goal.
double turn_left(const MotionState& robot, const MotionGoal& goal) {
  if (!goal.direction_rad) return 0.0;
  const double turn = wrap_angle(*goal.direction_rad - robot.heading_rad);
  return goal.exact_heading || std::abs(turn) <= 0.5 * kPi ? turn : turn - std::copysign(kPi, turn);
}

// Turns to a heading while it drives along the present one to the point nearest to the goal.
Velocities settle(const MotionState& robot, const MotionGoal& goal, double period_s, const MotionLimits& limits) {
  const double along = dot(goal.place - robot.place, unit_vector(robot.heading_rad));
  const double turn = turn_left(robot, goal);
  const ProfileLimits turning{limits.turn_radps, limits.turn_acceleration_radps2, kPeriodsAtPlace};
  return {next_speed(along, robot.v_mps, 0.0, period_s, {limits.speed_mps, limits.acceleration_mps2}),
          goal.direction_rad ? next_speed(turn, robot.w_radps, 0.0, period_s, turning) : 0.0};
}

bool is_at_place(const MotionState& robot, const MotionGoal& goal) {
  const Vector2 off = goal.place - robot.place;
  const double length = norm(off);
  // A robot that turns to its final heading moves by some mm, because no two wheels are equal. It finishes the turn.
  const double turn = turn_left(robot, goal);
  const double near =
      turn * robot.w_radps > 0.0 ? kAtPlace_m + std::min(std::abs(turn), 1.0) * kMovesPerTurn_m : kAtPlace_m;
  if (length < near) return true;
  if (length > kAlongLine_m || std::abs(robot.v_mps) > kSlow_mps) return false;
  const double line = goal.direction_rad.value_or(robot.heading_rad);
  return std::abs(cross(unit_vector(line), off)) < near;
}

// Largest speed of a robot whose direction differs by `error` from that of a point: it must turn on a circle that leads
// at most there, and what it drives to the side while it turns must be a small part of the way.
double speed_while_turning(double error, double length, const MotionLimits& limits, double period_s) {
  constexpr double kSidewards = 0.25;
  const double e = std::abs(error), sine = e < 0.5 * kPi ? std::sin(e) : 1.0;
  if (e > 0.75 * kPi) return 0.0;
  if (sine < 1e-3) return limits.speed_mps;
  const double turning =
      profile_time(e, 0.0, 0.0, {limits.turn_radps, limits.turn_acceleration_radps2}) + kPeriodsAtPlace * period_s;
  return std::min(limits.speed_on(0.5 * length / sine), kSidewards * length / (turning * sine));
}

// Near its goal, a robot steers as if the goal were still this far away: the bearing of a near point is mostly noise,
// and following it takes the wheels' acceleration from braking.
constexpr double kSteersFrom_m = 0.06;

Velocities follow(const MotionState& robot, const Route& route, double period_s, const MotionLimits& limits) {
  const double sign = route.backward ? -1.0 : 1.0;
  const double now = sign * robot.v_mps;
  const double facing = route.backward ? robot.heading_rad + kPi : robot.heading_rad;
  double error = wrap_angle(route.direction_rad - facing);
  if (route.line_m < kSteersFrom_m && std::abs(error) < 0.5) error *= route.line_m / kSteersFrom_m;
  const double speed =
      std::min(next_speed(route.line_m, now, 0.0, period_s, {limits.speed_mps, limits.acceleration_mps2}),
               speed_while_turning(error, route.line_m, limits, period_s));
  const double fast = std::min(1.0, std::abs(now) / kFast_mps);
  const ProfileLimits turning{limits.turn_at(now), limits.turn_acceleration_radps2,
                              kPeriodsAtPlace + fast * (kPeriodsOnWay - kPeriodsAtPlace)};
  const double turn = next_speed(error, robot.w_radps, 0.0, period_s, turning);
  return {sign * speed, std::clamp(turn, -turning.speed, turning.speed)};
}

}  // namespace

Twist drive(const MotionState& robot, const MotionGoal& goal, double period_s, const DriveParameters& drive,
            const MotionArea& area) {
  if (!is_finite(robot, goal) || !(period_s > 0.0)) return {};
  if (goal.end_speed_mps > 0.0) return drive_through(robot, goal, drive, area);
  const MotionLimits limits(drive);
  const Velocities wanted = is_at_place(robot, goal) ? settle(robot, goal, period_s, limits)
                                                     : follow(robot, best_route(robot, goal, limits), period_s, limits);
  return command_of(robot, shared(robot, wanted, period_s, limits), period_s, drive);
}

double time_to(const MotionState& robot, const MotionGoal& goal, const DriveParameters& drive, const MotionArea& area) {
  if (!is_finite(robot, goal)) return std::numeric_limits<double>::infinity();
  if (goal.end_speed_mps > 0.0) return time_through(robot, goal, drive, area);
  return best_route(robot, goal, MotionLimits(drive)).time_s;
}

Twist brake(const MotionState& robot, double period_s, const DriveParameters& drive) {
  const MotionLimits limits(drive);
  return command_of(robot, shared(robot, {}, period_s, limits), period_s, drive);
}

}  // namespace touchline
