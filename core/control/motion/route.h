#pragma once

#include <limits>

#include "core/control/motion/motion_goal.h"
#include "core/geometry/field_area.h"

namespace touchline {

/// Area in which the center of a robot may be.
struct MotionArea {
  double half_length_m = std::numeric_limits<double>::infinity();
  double half_width_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool contains(Vector2 p) const {
    return p.x >= -half_length_m && p.x <= half_length_m && p.y >= -half_width_m && p.y <= half_width_m;
  }
};

/// One way to a goal: turn (in place, or on a circle), drive straight, and turn again (on a circle, or in place).
/// Forward or backward.
struct Route {
  bool backward = false;
  double direction_rad = 0.0;    // wanted direction of motion now
  double curvature_per_m = 0.0;  // of the path at the robot
  double line_m = 0.0;           // way until the circle begins, or until the goal
  double line_end_mps = 0.0;     // speed at the end of this line
  double arc_m = 0.0;            // way on the circle and after it
  double end_mps = 0.0;          // speed at the goal
  double turn_at_end_rad = 0.0;  // turn in place at the goal
  double time_s = std::numeric_limits<double>::infinity();
};

/// Returns the fastest of all approaches: forward and backward, with a turn in place at the end or with the final
/// circle on each side, for several radii. A goal without a direction, or where the robot stops, can always be reached.
Route best_route(const MotionState& robot, const MotionGoal& goal, const MotionLimits& limits, const MotionArea& area);

}  // namespace touchline
