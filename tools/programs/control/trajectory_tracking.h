#pragma once

#include "core/control/motion/motion_goal.h"

namespace touchline {

/// Where a trajectory is when the command begins to act, and its velocities at the end of the period.
struct TrajectoryPoint {
  Vector2 place;
  double heading_rad = 0.0;
  double next_v_mps = 0.0, next_w_radps = 0.0;
};

/// Returns the command that keeps a robot on a trajectory: feed-forward of the trajectory's velocities, nonlinear
/// feedback (Samson 1993, in the form of De Luca, Oriolo, Vendittelli 2001, section 4.3), and the inverse of the
/// wheels' lag. A trajectory with a negative speed is driven backward. The limits of the drive are applied afterwards.
Twist track_point(const MotionState& robot, const TrajectoryPoint& reference, double period_s,
                  const DriveParameters& drive);

}  // namespace touchline
