#pragma once

#include "core/control/control_parameters.h"
#include "core/control/obstacle_avoidance.h"
#include "core/control/roles.h"
#include "core/geometry/field_area.h"
#include "core/types.h"

namespace touchline {

/// The default game: a goalkeeper that stays on its line, an attacker that pushes the ball to the opponent's goal, and
/// supporters behind and beside it. Without a ball, the goalkeeper guards the middle and the others stand still.
class Play {
 public:
  /// Sets the parameters; roles stay as they are.
  void configure(const ControlParameters& parameters, const FieldParameters& field);
  void reset() { roles_.reset(); }

  using Twists = std::array<Twist, kMaxRobotsPerTeam>;
  /// Computes the desired velocities of each player, without limits. `tracks` gives the ball and the obstacles.
  void decide(const Tracks& tracks, const Players& players, Twists& wanted);

  [[nodiscard]] const Roles& roles() const { return roles_; }
  [[nodiscard]] const FieldParameters& field() const { return field_; }

 private:
  [[nodiscard]] Twist guard(const Player& player, const BallTrack& ball) const;
  [[nodiscard]] Twist attack(const Player& player, const BallTrack& ball, const Obstacles& obstacles) const;
  [[nodiscard]] PushPlan plan_ahead(const BallTrack& ball, double time_s) const;
  [[nodiscard]] Twist support(const Player& player, Vector2 place, const PushPlan& plan,
                              const Obstacles& obstacles) const;

  ControlParameters parameters_;
  FieldParameters field_;
  Roles roles_;
};

}  // namespace touchline
