#pragma once

#include "core/control/motion/motion_goal.h"
#include "core/control/motion/route.h"

namespace touchline {

/// Returns the command with which a robot drives to its goal in the least time. Plans anew from the predicted state in
/// every frame. `period_s`: time until the next command acts. Obstacles: MotionPlanner.
Twist drive(const MotionState& robot, const MotionGoal& goal, double period_s, const DriveParameters& drive,
            const MotionArea& area = {});

/// Returns the time in which drive() reaches the goal, from the moment at which its first command acts.
double time_to(const MotionState& robot, const MotionGoal& goal, const DriveParameters& drive,
               const MotionArea& area = {});

/// Returns the command that stops the robot as quickly as its drive allows.
Twist brake(const MotionState& robot, double period_s, const DriveParameters& drive);

}  // namespace touchline
