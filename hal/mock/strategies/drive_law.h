#pragma once

#include "core/geometry/vector2.h"
#include "core/types.h"

// Simple control laws of the reference opponents. They drive backward as well as forward, whichever needs the smaller
// turn, and do not apply the drive's limits.
namespace touchline::hal::mock {

/// How a robot drives to a point.
struct DriveLaw {
  double speed_mps = 0.35;
  double turn_per_s = 4.0;      // angular velocity per radian of bearing error
  double max_turn_radps = 4.0;  // limit of this angular velocity
  double slow_within_m = 0.1;   // distance below which both velocities decrease in proportion; 0: never
};

/// Makes a Twist of two double values.
Twist to_twist(double v_mps, double w_radps);

/// Returns the turn to a direction, or to its opposite if that is nearer, in [-pi/2, pi/2]. `ahead`: 1 if the robot
/// then moves in this direction forward, -1 if backward.
double smaller_turn(const Pose& robot, double direction_rad, double& ahead);

/// Turns towards the target and drives to it.
Twist drive_to(const Pose& robot, Vector2 target, const DriveLaw& law);

/// Drives along a line to a place on it, and returns to the line. A robot on the line whose heading is along it does
/// not turn. `direction_rad`: of the line, in which `target` lies.
Twist drive_along(const Pose& robot, Vector2 target, double direction_rad, const DriveLaw& law);

}  // namespace touchline::hal::mock
