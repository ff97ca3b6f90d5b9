#pragma once

#include <numbers>
#include <optional>

#include "core/control/referee_state.h"
#include "core/geometry/vector2.h"

namespace touchline {

/// Sizes on which the places at a restart depend, in m.
struct RestartSizes {
  double length_m = 2.2, width_m = 1.8;
  double corner_m = 0.07;         // legs of the right triangles that fill the corners
  double circle_radius_m = 0.25;  // center circle
  double goal_area_depth_m = 0.15, goal_area_width_m = 0.7;
  double robot_radius_m = 0.053;  // of the circle around a robot
  double ball_radius_m = 0.0215;
};

/// What a robot has to do with a restart.
struct RestartPart {
  bool ours = false;  // its team takes the restart; false for a free ball
  bool is_goalkeeper = false, is_taker = false;
};

/// A place and the direction in which the robot looks.
struct RestartPlace {
  Vector2 position;
  double theta_rad = 0.0;
};

/// Where robots and ball are at a restart by the rules of MiroSot (FIRA, middle league) and of VSSS (CBR). All places
/// are in the coordinates of the robot's team, which attacks towards positive x.
class RestartRules {
 public:
  // Gap between bodies that are placed beside each other.
  static constexpr double kGapM = 0.01;

  explicit RestartRules(const RestartSizes& sizes);

  [[nodiscard]] const RestartSizes& sizes() const { return sizes_; }
  /// Returns the distance of the centers of robot and ball that do not touch, whatever the heading.
  [[nodiscard]] double reach_m() const { return reach_m_; }
  [[nodiscard]] bool in_goal_area(Vector2 place) const;
  [[nodiscard]] bool is_on_field(Vector2 place) const;
  /// Returns the mark of a free ball in the quadrant of `ball`.
  [[nodiscard]] Vector2 free_ball_mark(Vector2 ball) const;
  /// Returns the ball's place at a penalty kick of this team.
  [[nodiscard]] Vector2 penalty_mark() const;

  /// Returns the place of a robot that takes part in the restart, or of a goalkeeper that must be on its line; nullopt:
  /// the robot may choose its place.
  [[nodiscard]] std::optional<RestartPlace> fixed_place(Restart restart, const RestartPart& part, Vector2 ball) const;
  /// Returns whether the robot may be there at this restart.
  [[nodiscard]] bool is_legal(Restart restart, const RestartPart& part, Vector2 ball, Vector2 place) const;

  /// Returns the first place that `is_possible` accepts on circles around `here`, the smallest first. `direction`: 1.0,
  /// or -1.0 to begin each circle at the opposite point. nullopt: there is none.
  template <class IsPossible>
  [[nodiscard]] std::optional<Vector2> nearest_place(Vector2 here, double direction,
                                                     const IsPossible& is_possible) const {
    constexpr int kDirections = 24;
    const double step = 0.5 * sizes_.robot_radius_m, farthest = sizes_.length_m + sizes_.width_m;
    for (double way = step; way < farthest; way += step) {
      for (int k = 0; k < kDirections; ++k) {
        const Vector2 place = here + (direction * way) * unit_vector(2.0 * std::numbers::pi * k / kDirections);
        if (is_possible(place)) return place;
      }
    }
    return std::nullopt;
  }

 private:
  const RestartSizes sizes_;
  const double reach_m_;
};

}  // namespace touchline
