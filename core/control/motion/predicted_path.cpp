#include "core/control/motion/predicted_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/control/motion/speed_profile.h"
#include "core/geometry/angle.h"

namespace touchline {

PredictedPath constant_velocity(Vector2 place, Vector2 velocity_mps, double moves_s, double step_s) {
  PredictedPath path;
  for (std::size_t i = 0; i < path.at.size(); ++i) {
    path.at[i] = place + std::min(moves_s, step_s * static_cast<double>(i)) * velocity_mps;
  }
  return path;
}

double turning_time(const PathStart& robot, Vector2 way, const MotionLimits& limits) {
  const double turn = std::atan2(std::abs(cross(robot.facing, way)), std::abs(dot(robot.facing, way)));
  return profile_time(turn, 0.0, 0.0, {limits.turn_radps, limits.turn_acceleration_radps2});
}

PredictedPath along(const PathStart& robot, Vector2 via, Vector2 end, double turning_s, double step_s,
                    const MotionLimits& limits) {
  const Vector2 first = via - robot.place, second = end - via;
  const double first_m = norm(first), second_m = norm(second);
  const Vector2 first_ahead = first_m > 1e-9 ? (1.0 / first_m) * first : Vector2{1.0, 0.0};
  const Vector2 second_ahead = second_m > 1e-9 ? (1.0 / second_m) * second : first_ahead;
  const Vector2 facing = robot.facing;
  // The robot drives forward or backward, whichever needs the smaller turn.
  const double cosine = dot(facing, first_ahead), sine = std::abs(cross(facing, first_ahead));
  const double a = limits.acceleration_mps2, top = limits.speed_mps;
  // While it turns, the robot brakes the part of its velocity that leads elsewhere.
  const double begin = std::max(0.0, robot.v_mps * cosine * (sine < 0.5 ? 1.0 : 0.0));
  const Vector2 rest = robot.v_mps * facing - begin * first_ahead;
  const double rest_s = norm(rest) / a;
  const double ramp_s = std::max(0.0, top - begin) / a, total_m = first_m + second_m;
  PredictedPath path;
  for (std::size_t i = 0; i < path.at.size(); ++i) {
    const double time = step_s * static_cast<double>(i);
    const double t = begin > 0.0 ? time : std::max(0.0, time - turning_s);
    const double ramp = std::min(t, ramp_s);
    const double way = std::min(total_m, begin * ramp + 0.5 * a * ramp * ramp + (t - ramp) * top);
    const double braking = std::min(time, rest_s);
    const Vector2 drift = rest_s > 0.0 ? (braking - 0.5 * braking * braking / rest_s) * rest : Vector2{};
    path.at[i] = (way < first_m ? robot.place + way * first_ahead : via + (way - first_m) * second_ahead) + drift;
  }
  return path;
}

PredictedPath stopping(const MotionState& robot, double step_s, const MotionLimits& limits) {
  const double stops_s = std::abs(robot.v_mps) / limits.acceleration_mps2;
  const Vector2 velocity = robot.v_mps * unit_vector(robot.heading_rad);
  PredictedPath path;
  for (std::size_t i = 0; i < path.at.size(); ++i) {
    const double t = std::min(step_s * static_cast<double>(i), stops_s);
    path.at[i] = robot.place + (stops_s > 0.0 ? t - 0.5 * t * t / stops_s : 0.0) * velocity;
  }
  return path;
}

std::size_t first_conflict(const PredictedPath& path, const PathObstacles& obstacles, std::size_t least) {
  std::size_t first = PredictedPath::kSteps + 1;
  for (const PathObstacle& obstacle : obstacles) {
    const PredictedPath& other = *obstacle.path;
    const Vector2 apart = path.at[0] - other.at[0];
    // A rounding error must not stop a robot that passes beside a standing one.
    constexpr double kNearer = 0.98;
    const double least2 = std::min(obstacle.clearance_m * obstacle.clearance_m, kNearer * dot(apart, apart));
    for (std::size_t i = 1; i <= std::min(obstacle.steps, PredictedPath::kSteps) && i < first;) {
      const Vector2 begin = path.at[i - 1] - other.at[i - 1];
      // Steps in which the two cannot meet are not examined.
      const double far = std::sqrt(dot(begin, begin)) - obstacle.clearance_m;
      if (far > obstacle.step_m) {
        i += static_cast<std::size_t>(far / obstacle.step_m);
        continue;
      }
      const Vector2 change = (path.at[i] - other.at[i]) - begin;
      const double length2 = dot(change, change);
      const double at = length2 > 0.0 ? std::clamp(-dot(begin, change) / length2, 0.0, 1.0) : 0.0;
      const Vector2 nearest = begin + at * change;
      if (dot(nearest, nearest) < least2) first = i;
      ++i;
    }
    if (first < least) return first;
  }
  return first;
}

}  // namespace touchline
