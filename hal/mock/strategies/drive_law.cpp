#include "hal/mock/strategies/drive_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::hal::mock {

Twist to_twist(double v_mps, double w_radps) { return {static_cast<float>(v_mps), static_cast<float>(w_radps)}; }

double smaller_turn(const Pose& robot, double direction_rad, double& ahead) {
  const double turn = wrap_angle(direction_rad - heading(robot));
  ahead = std::abs(turn) <= 0.5 * std::numbers::pi ? 1.0 : -1.0;
  return ahead > 0.0 ? turn : wrap_angle(turn + std::numbers::pi);
}

Twist drive_to(const Pose& robot, Vector2 target, const DriveLaw& law) {
  const Vector2 way = target - position(robot);
  const double length = norm(way);
  if (length <= 0.0) return {};
  double ahead = 1.0;
  const double off = smaller_turn(robot, bearing(way), ahead);
  const double near = law.slow_within_m > 0.0 ? std::min(1.0, length / law.slow_within_m) : 1.0;
  const double turn = std::clamp(law.turn_per_s * off, -law.max_turn_radps, law.max_turn_radps);
  return to_twist(ahead * near * std::cos(off) * law.speed_mps, near * turn);
}

Twist drive_along(const Pose& robot, Vector2 target, double direction_rad, const DriveLaw& law) {
  // The way back to the line is at most this steep, and less near the target, where the direction of motion changes.
  constexpr double kMaxTilt = 0.5, kTiltPerM = 6.0;
  const Vector2 line = unit_vector(direction_rad);
  const Vector2 way = target - position(robot);
  const double along = dot(way, line), beside = cross(line, way);
  const double near = law.slow_within_m > 0.0 ? std::min(1.0, std::abs(along) / law.slow_within_m) : 1.0;
  const double tilt = near * std::clamp(kTiltPerM * beside, -kMaxTilt, kMaxTilt);
  const double motion = along >= 0.0 ? direction_rad + tilt : direction_rad + std::numbers::pi - tilt;
  double ahead = 1.0;
  const double off = smaller_turn(robot, motion, ahead);
  const double turn = std::clamp(law.turn_per_s * off, -law.max_turn_radps, law.max_turn_radps);
  return to_twist(ahead * near * std::cos(off) * law.speed_mps, turn);
}

}  // namespace touchline::hal::mock
