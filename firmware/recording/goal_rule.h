#pragma once

#include <optional>

#include "core/geometry/field_area.h"
#include "core/types.h"

namespace touchline::recording {

/// Detects goals where no referee counts them: the whole ball is behind a goal line, between the posts. A ball that was
/// brought back to the field can score again.
class GoalRule {
 public:
  GoalRule(const FieldParameters& field, float ball_radius_m);

  /// Takes the ball of one frame. `own_on_positive_half`: the own team defends the goal at positive x. Returns the team
  /// that has scored with this frame.
  std::optional<Team> add(const BallTrack& ball, bool own_on_positive_half);

 private:
  float line_m_, mouth_m_, radius_m_;
  int frames_ = 0;  // in a row in which the ball was seen in a goal
  bool is_counted_ = false;
};

}  // namespace touchline::recording
