#pragma once

#include "core/control/strategy.h"
#include "core/geometry/field_area.h"
#include "core/types.h"
#include "tools/programs/simulate/release_0_1/obstacle_avoidance.h"
#include "tools/programs/simulate/release_0_1/parameters.h"
#include "tools/programs/simulate/release_0_1/roles.h"
#include "tools/programs/simulate/release_0_1/stuck_monitor.h"

namespace touchline::release_0_1 {

/// The built-in play of release 0.1 (README.md): a goalkeeper that stays on its line, an attacker that pushes the ball
/// to the opponent's goal, and supporters behind and beside it. Without a ball, the goalkeeper guards the middle and
/// the others stand still.
class Play final : public Strategy {
 public:
  virtual ~Play() = default;

  /// Takes the parameters that release 0.1 has from `parameters`.
  void configure(const touchline::ControlParameters& parameters, const FieldParameters& field) override;
  void reset() override;
  void decide(const Tracks& tracks, const Players& players, Twists& wanted) override;
  [[nodiscard]] PlayRole role_of(RobotId id) const override { return roles_.role_of(id); }

  [[nodiscard]] const Roles& roles() const { return roles_; }
  [[nodiscard]] const FieldParameters& field() const { return field_; }

 private:
  struct Watched {
    RobotId id = kUnknownId;
    StuckMonitor stuck;
  };
  void free_jams(const Tracks& tracks, const Players& players, Twists& wanted);
  [[nodiscard]] Twist guard(const Player& player, const BallTrack& ball) const;
  [[nodiscard]] Twist attack(const Player& player, const BallTrack& ball, const Obstacles& obstacles) const;
  [[nodiscard]] PushPlan plan_ahead(const BallTrack& ball, double time_s) const;
  [[nodiscard]] Twist support(const Player& player, Vector2 place, const PushPlan& plan,
                              const Obstacles& obstacles) const;

  ControlParameters parameters_;
  FieldParameters field_;
  Roles roles_;
  FixedVector<Watched, kMaxRobotsPerTeam> watched_;  // the players of the last decision
};

}  // namespace touchline::release_0_1
