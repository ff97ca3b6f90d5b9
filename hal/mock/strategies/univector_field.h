#pragma once

#include <span>

#include "core/geometry/vector2.h"

// Univector field: for each place, the direction in which a robot moves there. Kim, Kim, Kim, Kim, Vadakkepat,
// "Univector field method based path planning for soccer robots" (hyperbolic spirals around a target, 2001), and Lim,
// Choi, Kim, Kim, "Evolutionary univector field-based navigation with collision avoidance for mobile robot" (obstacles,
// 2008). The code of many VSSS teams is based on them.
namespace touchline::hal::mock {

/// Which of the two spirals lead to the target: both (a robot takes the nearer one), or only the one whose center is to
/// the left or to the right of the target's direction, for a target beside a wall.
enum class Spirals { kBoth, kLeft, kRight };

struct FieldTarget {
  Vector2 place;
  double direction_rad = 0.0;  // direction of motion at the place
  Spirals spirals = Spirals::kBoth;
  // Radius d_e and transition K_r of the spirals: the evolved values that VSSS teams took over, for robots of 75 mm.
  double radius_m = 0.0537, transition_m = 0.0415;
};

struct MovingObstacle {
  Vector2 position, velocity;
};

struct AvoidanceParameters {
  // The evolved width delta of the transition, and the time K_o for which the obstacle's motion relative to the robot
  // shifts it. Within the distance d_min the robot drives straight away from the obstacle.
  double width_m = 0.0457, lead_s = 0.12, min_distance_m = 0.0948;
};

/// Direction to the target from p. It is continuous except far in front of the target, where the sides part.
[[nodiscard]] double direction_to_target(Vector2 p, const FieldTarget& target);

/// Returns `direction_rad`, turned away from the obstacle that is the nearest after its shift. `velocity`: of the
/// robot.
[[nodiscard]] double avoiding_direction(Vector2 p, double direction_rad, Vector2 velocity,
                                        std::span<const MovingObstacle> obstacles,
                                        const AvoidanceParameters& parameters);

}  // namespace touchline::hal::mock
