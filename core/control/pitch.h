#pragma once

#include <algorithm>
#include <cmath>

#include "core/control/control_parameters.h"
#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"

namespace touchline {

/// The field with the sizes of robots and ball, as the play needs them. The own goal is at negative x.
struct Pitch {
  double end_m = 1.1, side_m = 0.9;           // half length and half width
  double mouth_m = 0.2;                       // half width of the goals
  double area_depth_m = 0.2, area_m = 0.3;    // the own goal area: depth and half width
  double robot_m = 0.0375, ball_m = 0.02135;  // half side of a robot, radius of the ball
  BallMotionParameters rolling;               // of the ball

  Pitch() = default;
  Pitch(const FieldParameters& field, const PlayParameters& play, const BallMotionParameters& ball = {})
      : end_m(0.5 * static_cast<double>(field.length_m)),
        side_m(0.5 * static_cast<double>(field.width_m)),
        mouth_m(0.5 * static_cast<double>(field.goal_width_m)),
        robot_m(play.robot_radius_m),
        ball_m(play.ball_radius_m),
        rolling(ball) {
    // A field without a painted area gets one in which the goalkeeper needs the space: half as deep as the goal is
    // wide.
    const bool painted = field.penalty_area_depth_m > 0.0f && field.penalty_area_width_m > 0.0f;
    area_depth_m = painted ? static_cast<double>(field.penalty_area_depth_m) : mouth_m;
    area_m = painted ? 0.5 * static_cast<double>(field.penalty_area_width_m) : mouth_m + 2.0 * robot_m;
  }

  [[nodiscard]] Vector2 own_goal() const { return {-end_m, 0.0}; }
  [[nodiscard]] Vector2 far_goal() const { return {end_m, 0.0}; }
  /// Distance of the centers when a robot's front touches the ball.
  [[nodiscard]] double contact_m() const { return robot_m + ball_m; }
  [[nodiscard]] Vector2 inside(Vector2 p, double margin_m) const {
    const double x = std::max(0.0, end_m - margin_m), y = std::max(0.0, side_m - margin_m);
    return {std::clamp(p.x, -x, x), std::clamp(p.y, -y, y)};
  }
  /// Sum of the normals of the walls that a robot there would touch when it turns; zero: there is room.
  [[nodiscard]] Vector2 away_from_walls(Vector2 p) const {
    const double turning = 1.5 * robot_m;  // half the diagonal and some tolerance
    Vector2 away;
    if (std::abs(p.y) > side_m - turning) away.y -= std::copysign(1.0, p.y);
    if (std::abs(p.x) > end_m - turning && std::abs(p.y) > mouth_m - turning) away.x -= std::copysign(1.0, p.x);
    return away;
  }
  /// Returns whether a point is in the own goal area, enlarged by the margin, or in the own goal.
  [[nodiscard]] bool in_own_area(Vector2 p, double margin_m) const {
    return p.x < -end_m + area_depth_m + margin_m && std::abs(p.y) < area_m + margin_m;
  }
};

}  // namespace touchline
