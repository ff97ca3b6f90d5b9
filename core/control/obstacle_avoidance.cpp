#include "core/control/obstacle_avoidance.h"

#include <algorithm>
#include <cmath>

#include "core/control/motion/drive_through.h"

namespace touchline {

Vector2 detour(Vector2 from, Vector2 velocity, Vector2 target, const RoundObstacles& obstacles, const Pitch& pitch) {
  const Vector2 way = target - from;
  const double length = norm(way);
  if (length < 1e-6) return target;
  const Vector2 ahead = (1.0 / length) * way;
  const double speed = std::max(0.4, norm(velocity));
  const RoundObstacle* blocking = nullptr;
  Vector2 there;
  double nearest = length;
  for (const RoundObstacle& obstacle : obstacles) {
    // Where it is when the robot comes by, at most 0.4 s later.
    const double meet = std::clamp(dot(obstacle.position - from, ahead) / speed, 0.0, 0.4);
    const Vector2 p = obstacle.position + meet * obstacle.velocity;
    const double along = dot(p - from, ahead), beside = cross(ahead, p - from);
    if (along <= 0.0 || along >= nearest || std::abs(beside) >= obstacle.clearance_m) continue;
    if (distance(p, target) < 0.8 * obstacle.clearance_m) continue;
    nearest = along;
    blocking = &obstacle;
    there = p;
  }
  if (blocking == nullptr) return target;
  constexpr double kBeyond = 1.1;  // slightly more than the clearance
  const double side = cross(ahead, there - from) > 0.0 ? -1.0 : 1.0;
  const Vector2 offset = (kBeyond * side * blocking->clearance_m) * perpendicular(ahead);
  const auto fits = [&](Vector2 p) { return distance(p, pitch.inside(p, 1.2 * pitch.robot_m)) < 1e-9; };
  return fits(there + offset) || !fits(there - offset) ? there + offset : there - offset;
}

Twist leave_contact(const Twist& wanted, const MotionState& robot, const RoundObstacles& obstacles, const Pitch& pitch,
                    const DriveParameters& drive) {
  constexpr double kMuchRad = 0.5, kAlong = 0.5, kLeaveMps = 0.4;
  // The turn rate from which the wheels stop the turn within this angle.
  const double much = std::sqrt(2.0 * drive.max_wheel_acceleration_mps2 / drive.wheel_base_m * kMuchRad);
  if (std::abs(static_cast<double>(wanted.w_radps)) < std::min(much, drive.max_turn_radps)) return wanted;
  Vector2 away = pitch.away_from_walls(robot.place);
  for (const RoundObstacle& obstacle : obstacles) {
    const Vector2 from = robot.place - obstacle.position;
    const double d = norm(from);
    if (d > 1e-6 && d < 2.5 * pitch.robot_m) away = away + (1.0 / d) * from;
  }
  const double length = norm(away), along = dot(away, unit_vector(robot.heading_rad));
  if (length < 1e-6 || std::abs(along) < kAlong * length) return wanted;
  return {static_cast<float>(std::copysign(kLeaveMps, along)), 0.3f * wanted.w_radps};
}

Twist slow_before(Twist wanted, const MotionState& robot, const RoundObstacles& obstacles) {
  constexpr double kBrakePerS = 4.0;
  const Vector2 here =
      robot.place + (kResponseS * robot.v_mps) * unit_vector(robot.heading_rad + 0.5 * kResponseS * robot.w_radps);
  const Vector2 facing = unit_vector(robot.heading_rad + kResponseS * robot.w_radps);
  const Vector2 ahead = wanted.v_mps < 0.0f ? -facing : facing;
  for (const RoundObstacle& obstacle : obstacles) {
    if (obstacle.brake_m <= 0.0) continue;
    const Vector2 to = obstacle.position + kResponseS * obstacle.velocity - here;
    const double d = norm(to);
    if (d > 2.0 * obstacle.clearance_m || dot(to, ahead) < 0.6 * d) continue;
    const auto most = static_cast<float>(std::max(0.0, kBrakePerS * (d - obstacle.brake_m)));
    wanted.v_mps = std::clamp(wanted.v_mps, -most, most);
  }
  return wanted;
}

}  // namespace touchline
