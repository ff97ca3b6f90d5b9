#include "tools/programs/control/trajectory_tracking.h"

#include <algorithm>
#include <cmath>

#include "core/control/motion/drive_limits.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

// Gains of a figure eight at 1 m/s with slip, six seeds each. More stiffness is better by 0.5 mm without delay, and
// worse by 10 mm with 100 ms of radio delay (docs/control.md).
constexpr double kDamping = 0.8;
constexpr double kStiffness_per_m2 = 100.0;  // square of the natural frequency per meter of way
constexpr double kFloor_per_s = 4.0;         // natural frequency if the reference does not move
constexpr double kAlong_per_s = 8.0;
// Farther from the trajectory, the proof of convergence holds for the kinematics alone: the wheels cannot follow.
constexpr double kFarthest_m = 0.10;

double sinc(double a) { return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a; }

}  // namespace

Twist track_point(const MotionState& robot, const TrajectoryPoint& reference, double period_s,
                  const DriveParameters& drive) {
  const Vector2 off = reference.place - robot.place, ahead = unit_vector(robot.heading_rad);
  const double ex = std::clamp(dot(off, ahead), -kFarthest_m, kFarthest_m);
  const double ey = std::clamp(cross(ahead, off), -kFarthest_m, kFarthest_m);
  const double turned = wrap_angle(reference.heading_rad - robot.heading_rad);
  const double v = reference.next_v_mps, w = reference.next_w_radps;
  if (!std::isfinite(ex + ey + turned + v + w) || !(period_s > 0.0)) return {};
  const double frequency = std::max(std::sqrt(w * w + kStiffness_per_m2 * v * v), kFloor_per_s);
  const double wanted_v = v * std::cos(turned) + kAlong_per_s * ex;
  const double wanted_w = w + kStiffness_per_m2 * v * sinc(turned) * ey + 2.0 * kDamping * frequency * turned;
  return command_to_change(robot, wanted_v - robot.v_mps, wanted_w - robot.w_radps, period_s, drive);
}

}  // namespace touchline
