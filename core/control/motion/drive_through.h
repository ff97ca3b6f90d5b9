#pragma once

#include "core/control/motion/motion_goal.h"
#include "core/control/motion/route.h"

namespace touchline {

/// A law for the pose at which the wheels have followed for the most part does not oscillate. Best for wheels with a
/// lag of 80 ms, and for robots whose tires slide when they accelerate (docs/control.md): with the 0.2 s that describe
/// their speeds best, no resting ball was struck.
inline constexpr double kResponseS = 0.08;

/// Returns the command of a robot that drives through a place with a speed, and in a direction if the goal has one.
/// Forward or backward: turn, line, and an arc that ends at the place. The command is that for the pose at which the
/// wheels have followed, without limits of the acceleration.
Twist drive_through(const MotionState& robot, const MotionGoal& goal, const DriveParameters& drive,
                    const MotionArea& area);

/// Returns a lower bound of time_through() to a place, whatever the direction there, for a hundredth of its work.
double least_time_through(const MotionState& robot, Vector2 place, const DriveParameters& drive);

/// Estimates the time in s until the robot passes the place, from the moment at which the first command acts.
double time_through(const MotionState& robot, const MotionGoal& goal, const DriveParameters& drive,
                    const MotionArea& area);

}  // namespace touchline
