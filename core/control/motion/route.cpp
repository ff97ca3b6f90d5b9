#include "core/control/motion/route.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/control/motion/speed_profile.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

// Share of a turn's time that a drive takes longer: the rest overlaps with acceleration and braking. Measured: the
// times of 200 random poses (tools/evaluate-control) fit best with it.
constexpr double kTurnShare = 0.85;

// On a circle at the end of braking instead of the turn in place, a robot would save 0.1 s at most, and the wheels'
// acceleration, which braking needs, would not suffice for both.
Route straight(const MotionState& robot, const MotionGoal& goal, const MotionLimits& limits, bool backward) {
  const Vector2 way = goal.place - robot.place;
  const double facing = backward ? robot.heading_rad + std::numbers::pi : robot.heading_rad;
  const double begin_mps = backward ? -robot.v_mps : robot.v_mps;
  Route route;
  route.backward = backward;
  route.line_m = norm(way);
  route.direction_rad = route.line_m > 1e-9 ? bearing(way) : facing;
  if (goal.direction_rad) {
    const double final_heading = *goal.direction_rad + (backward ? std::numbers::pi : 0.0);
    route.turn_at_end_rad = wrap_angle(final_heading - route.direction_rad);
    if (!goal.exact_heading && std::abs(route.turn_at_end_rad) > 0.5 * std::numbers::pi)
      route.turn_at_end_rad -= std::copysign(std::numbers::pi, route.turn_at_end_rad);
  }
  const ProfileLimits driving{limits.speed_mps, limits.acceleration_mps2};
  const ProfileLimits turning{limits.turn_radps, limits.turn_acceleration_radps2};
  const double error = wrap_angle(route.direction_rad - facing);
  const double towards = error < 0.0 ? -robot.w_radps : robot.w_radps;
  double time = kTurnShare * profile_time(std::abs(error), std::max(0.0, towards), 0.0, turning);
  if (route.turn_at_end_rad != 0.0)
    time += kTurnShare * profile_time(std::abs(route.turn_at_end_rad), 0.0, 0.0, turning);
  // A robot that has to turn far loses the part of its speed that points away.
  const double begin = begin_mps > 0.0 ? begin_mps * std::max(0.0, std::cos(error)) : begin_mps;
  time += (begin_mps > begin ? begin_mps - begin : 0.0) / limits.acceleration_mps2;
  time += profile_time(route.line_m, begin, 0.0, driving);
  // The last part of the acceleration to full speed follows the lag (motion_goal.h): its way is a lag^2 / 2 shorter.
  time += 0.5 * limits.acceleration_mps2 * limits.lag_s * limits.lag_s / limits.speed_mps;
  route.time_s = time;
  return route;
}

}  // namespace

Route best_route(const MotionState& robot, const MotionGoal& goal, const MotionLimits& limits) {
  const Route forward = straight(robot, goal, limits, false), backward = straight(robot, goal, limits, true);
  return backward.time_s < forward.time_s ? backward : forward;
}

}  // namespace touchline
