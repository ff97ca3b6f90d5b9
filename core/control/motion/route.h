#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/control/motion/motion_goal.h"

namespace touchline {

/// Area in which the center of a robot may be.
struct MotionArea {
  double half_length_m = std::numeric_limits<double>::infinity();
  double half_width_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool contains(Vector2 p) const {
    return p.x >= -half_length_m && p.x <= half_length_m && p.y >= -half_width_m && p.y <= half_width_m;
  }
  /// Distance of a point to the area; 0 inside.
  [[nodiscard]] double outside_m(Vector2 p) const {
    return std::hypot(std::max(0.0, std::abs(p.x) - half_length_m), std::max(0.0, std::abs(p.y) - half_width_m));
  }
};

/// A way to a goal where the robot stops: turn in place, drive straight, turn in place. Forward or backward.
struct Route {
  bool backward = false;
  double direction_rad = 0.0;    // of the motion
  double line_m = 0.0;           // way until the goal
  double turn_at_end_rad = 0.0;  // turn in place at the goal
  double time_s = std::numeric_limits<double>::infinity();
};

/// Returns the faster of both ways, forward and backward. The goal's speed is ignored.
Route best_route(const MotionState& robot, const MotionGoal& goal, const MotionLimits& limits);

}  // namespace touchline
