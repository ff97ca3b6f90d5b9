#include "tools/programs/simulate/release_0_1/motion_laws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::release_0_1 {
namespace {

constexpr double kPi = std::numbers::pi;

double sinc(double a) { return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a; }

Twist twist(double v, double w) { return {static_cast<float>(v), static_cast<float>(w)}; }

// Maps an angle to (-pi/2, pi/2], modulo pi: for a robot that may drive forward or backward.
double fold(double angle) {
  const double wrapped = wrap_angle(angle);
  if (wrapped > 0.5 * kPi) return wrapped - kPi;
  if (wrapped <= -0.5 * kPi) return wrapped + kPi;
  return wrapped;
}

}  // namespace

Pose reversed(const Pose& pose) { return {pose.position, wrap_to_float(heading(pose) + kPi)}; }

Twist go_to_point(const Pose& robot, Vector2 target, bool arrive, double max_speed_mps, const MotionParameters& gains) {
  const Vector2 way = target - position(robot);
  const double length = norm(way);
  if (arrive && length < gains.arrived_m) return {};
  const double ahead = wrap_angle(bearing(way) - heading(robot));
  const double off = fold(ahead);
  const double sign = std::abs(ahead) > 0.5 * kPi ? -1.0 : 1.0;
  const double speed = arrive ? std::min(gains.distance_per_s * length, max_speed_mps) : max_speed_mps;
  return twist(sign * speed * std::cos(off), gains.bearing_per_s * off);
}

Twist go_to_pose(const Pose& robot, const Twist& now, const Pose& target, Facing facing, double max_speed_mps,
                 const MotionParameters& gains) {
  const Vector2 way = position(target) - position(robot);
  const double e = norm(way);
  if (e < gains.arrived_m) return turn_to(robot, heading(target), facing, gains);

  // Four options: forward or backward, arriving with the given heading or rotated by 180 degrees.
  constexpr double kHysteresis = 0.4;  // radians that a change of the driving direction must save
  double best = 1e9, alpha = 0.0, theta = 0.0, sign = 1.0;
  for (const double drive : {1.0, -1.0}) {
    const double start = drive > 0.0 ? heading(robot) : heading(robot) + kPi;
    for (const bool turned : {false, true}) {
      if (turned && facing == Facing::kExact) continue;
      // A robot that drives backward arrives with its back first, so its heading is as requested.
      const double end = heading(target) + ((drive < 0.0) != turned ? kPi : 0.0);
      const double a = wrap_angle(bearing(way) - start), t = wrap_angle(bearing(way) - end);
      const double keep = drive * static_cast<double>(now.v_mps) > 0.1 ? kHysteresis : 0.0;
      const double cost = std::abs(a) + 0.5 * std::abs(t) - keep;
      if (cost >= best) continue;
      best = cost;
      alpha = a;
      theta = t;
      sign = drive;
    }
  }
  const double speed = std::min(gains.distance_per_s * e, max_speed_mps);  // gamma e in the article
  const double v = speed * std::cos(alpha);
  const double w =
      gains.bearing_per_s * alpha + speed / e * std::cos(alpha) * sinc(alpha) * (alpha + gains.approach_weight * theta);
  return twist(sign * v, w);
}

Twist track_trajectory(const Pose& robot, const Pose& reference, const Twist& reference_twist,
                       const MotionParameters& gains) {
  const Vector2 off = position(reference) - position(robot);
  const Vector2 ahead = unit_vector(heading(robot));
  const double ex = dot(off, ahead), ey = cross(ahead, off);
  const double eh = wrap_angle(heading(reference) - heading(robot));
  const double v = static_cast<double>(reference_twist.v_mps), w = static_cast<double>(reference_twist.w_radps);
  const double frequency = std::max(std::sqrt(w * w + gains.tracking_per_m2 * v * v), gains.tracking_floor_per_s);
  const double k13 = 2.0 * gains.tracking_damping * frequency;
  return twist(v * std::cos(eh) + k13 * ex, w + gains.tracking_per_m2 * v * sinc(eh) * ey + k13 * eh);
}

Twist turn_to(const Pose& robot, double heading_rad, Facing facing, const MotionParameters& gains) {
  const double off = heading_rad - heading(robot);
  return twist(0.0, gains.heading_per_s * (facing == Facing::kEither ? fold(off) : wrap_angle(off)));
}

}  // namespace touchline::release_0_1
