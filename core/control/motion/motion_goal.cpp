#include "core/control/motion/motion_goal.h"

#include <algorithm>
#include <cmath>

#include "core/control/motion/drive_limits.h"

namespace touchline {
namespace {

// Plans use a part of the acceleration. The rest turns a robot while it brakes, and corrects errors: with all of it, a
// robot that is 2 % faster than planned passes its goal.
constexpr double kPlannedShare = 0.85;
// Part of the grip that plans use sideways: random slip of the wheels (3 % of the speed) and corrections need the rest.
constexpr double kLateralShare = 0.85;
// For robots whose grip is not known.
constexpr double kLargeGrip = 100.0;

}  // namespace

Twist command_to_change(const MotionState& robot, double change_mps, double change_radps, double period_s,
                        const DriveParameters& drive) {
  const Twist target{robot.wheels.v_mps + static_cast<float>(change_mps),
                     robot.wheels.w_radps + static_cast<float>(change_radps)};
  return command_for(target, robot.wheels, period_s, drive);
}

MotionLimits::MotionLimits(const DriveParameters& drive)
    : speed_mps(std::min(drive.max_speed_mps, drive.max_wheel_speed_mps)),
      wheel_mps(drive.max_wheel_speed_mps),
      turn_radps(std::min(drive.max_turn_radps, 2.0 * drive.max_wheel_speed_mps / drive.wheel_base_m)),
      half_base_m(0.5 * drive.wheel_base_m),
      wheel_acceleration_mps2(drive.max_wheel_acceleration_mps2),
      acceleration_mps2(kPlannedShare * drive.max_wheel_acceleration_mps2),
      turn_acceleration_radps2(acceleration_mps2 / half_base_m),
      lateral_mps2(kLateralShare * (drive.tire_grip_mps2 > 0.0 ? drive.tire_grip_mps2 : kLargeGrip)),
      lag_s(drive.wheel_lag_s) {
  if (drive.tire_grip_mps2 > 0.0) acceleration_mps2 = std::min(acceleration_mps2, lateral_mps2);
}

double MotionLimits::speed_on(double radius_m) const {
  return std::min({speed_mps, std::sqrt(lateral_mps2 * radius_m), turn_radps * radius_m,
                   wheel_mps * radius_m / (radius_m + half_base_m)});
}

double MotionLimits::turn_at(double speed) const {
  const double v = std::abs(speed);
  double turn = std::min(turn_radps, std::max(0.0, wheel_mps - v) / half_base_m);
  if (v * turn > lateral_mps2) turn = lateral_mps2 / v;
  return turn;
}

}  // namespace touchline
