#pragma once

#include <optional>

#include "core/control/control_parameters.h"
#include "core/control/pitch.h"
#include "core/control/player.h"
#include "core/fixed_vector.h"
#include "core/geometry/vector2.h"

// What a skill wants of a robot's motion, and how the robot drives there.
namespace touchline {

/// A curve to the ball ends so far before the contact; the robot drives the rest straight, so that errors of the curve
/// decay. 20 of 150 resting balls more were struck towards the goal than without.
inline constexpr double kRunUpM = 0.03;

struct SkillGoal {
  Vector2 place{};
  // Of the motion at the place; none: any. If end_speed_mps is 0, the robot turns to this direction after it arrives,
  // front or back ahead.
  std::optional<double> direction_rad{};
  double end_speed_mps = 0.0;  // speed at the place; 0: the robot stops there
  bool avoid_ball = false;
  std::optional<Twist> twist{};  // drive these velocities instead
};

/// A robot or the ball that another robot drives around.
struct RoundObstacle {
  Vector2 position, velocity;
  double clearance_m = 0.0;  // least distance of the centers
  double brake_m = 0.0;      // the robot brakes so that it does not come nearer; 0: it does not brake
};
using RoundObstacles = FixedVector<RoundObstacle, kMaxRobots + 1>;

/// Returns the velocities that bring the robot to its goal, around the obstacles and without limits of the drive.
/// Drives forward or backward, whichever is sooner.
Twist drive(const Player& robot, const SkillGoal& goal, const RoundObstacles& obstacles, const Pitch& pitch,
            const DriveParameters& limits);

/// Estimates the time in s until the robot is at its goal, without obstacles.
double time_to(const Player& robot, const SkillGoal& goal, const Pitch& pitch, const DriveParameters& limits);

}  // namespace touchline
