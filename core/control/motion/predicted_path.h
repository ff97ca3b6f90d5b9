#pragma once

#include <array>

#include "core/control/motion/motion_goal.h"
#include "core/fixed_vector.h"

namespace touchline {

/// Positions of a robot at equal time steps, from now (index 0) on.
struct PredictedPath {
  // 1.2 s at full speed: twice the time in which a robot turns and brakes.
  static constexpr std::size_t kSteps = 12;
  std::array<Vector2, kSteps + 1> at;
};

/// Where a predicted path begins.
struct PathStart {
  explicit PathStart(const MotionState& robot)
      : place(robot.place), facing(unit_vector(robot.heading_rad)), v_mps(robot.v_mps) {}
  Vector2 place, facing;
  double v_mps;
};

/// Something that a robot must not touch, with the way that it is expected to go.
struct PathObstacle {
  const PredictedPath* path = nullptr;
  double clearance_m = 0.0;                   // between the centers
  double step_m = 0.0;                        // longest way in a step, together with the robot that avoids it
  std::size_t steps = PredictedPath::kSteps;  // later, it may be anywhere and is ignored
};
// The other robots of both teams.
using PathObstacles = FixedVector<PathObstacle, kMaxRobots>;

/// Predicts constant velocity, as long as `moves_s`; then the object stands.
PredictedPath constant_velocity(Vector2 place, Vector2 velocity_mps, double moves_s, double step_s);

/// Predicts a robot that turns towards `via`, drives there and on to `end`, where it stops or not, within the limits.
/// Corners are driven in no time; the turn at the start takes its time.
PredictedPath along(const PathStart& robot, Vector2 via, Vector2 end, double turning_s, double step_s,
                    const MotionLimits& limits);

/// Returns the time in which a robot turns to a way, forward or backward.
double turning_time(const PathStart& robot, Vector2 way, const MotionLimits& limits);

/// Predicts a robot that brakes.
PredictedPath stopping(const MotionState& robot, double step_s, const MotionLimits& limits);

/// Returns the number of the first step in which the path comes nearer to an obstacle than its clearance, or kSteps
/// + 1. Between two steps, both move straight. An obstacle that is already nearer counts if it comes still nearer. Any
/// result below `least` means only that there is a conflict before that step.
std::size_t first_conflict(const PredictedPath& path, const PathObstacles& obstacles, std::size_t least = 0);

}  // namespace touchline
