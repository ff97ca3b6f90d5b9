#pragma once

#include "core/control/motion/motion_goal.h"
#include "core/control/pitch.h"
#include "core/fixed_vector.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

// How robots of a game drive around others: quickly, and without waiting for opponents. MotionPlanner, which drives
// robots to the poses of other programs, waits; in a game this costs goals (docs/control.md).
namespace touchline {

/// A robot or the ball that another robot drives around.
struct RoundObstacle {
  Vector2 position{}, velocity{};
  double clearance_m = 0.0;  // least distance of the centers
  double brake_m = 0.0;      // the robot brakes so that it does not come nearer; 0: it does not brake
};
// All robots and the ball.
using RoundObstacles = FixedVector<RoundObstacle, kMaxRobots + 1>;

/// Returns the next waypoint on the way to `target`: the target itself if the straight way is free, else a point beside
/// the nearest blocking obstacle, on the shorter side that is on the field. An obstacle at the target does not block,
/// because the robot is meant to go there. `velocity`: of the robot that moves.
Vector2 detour(Vector2 from, Vector2 velocity, Vector2 target, const RoundObstacles& obstacles, const Pitch& pitch);

/// A robot that must turn much but touches a wall or another robot leaves it first: its corners need room.
Twist leave_contact(const Twist& wanted, const MotionState& robot, const RoundObstacles& obstacles, const Pitch& pitch,
                    const DriveParameters& drive);

/// Slows down before obstacles with a brake_m, by their places and that of the robot when the wheels have followed.
Twist slow_before(Twist wanted, const MotionState& robot, const RoundObstacles& obstacles);

}  // namespace touchline
