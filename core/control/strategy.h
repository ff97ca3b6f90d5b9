#pragma once

#include <array>

#include "core/control/control_parameters.h"
#include "core/control/player.h"
#include "core/control/referee_state.h"
#include "core/geometry/field_area.h"
#include "core/types.h"

namespace touchline {

/// Decides how the own robots move. The built-in Play is one; the arena's reference opponents are others. A strategy
/// sees its own team as Team::kOwn and attacks towards positive x. Nothing is allocated after configure().
class Strategy {
 public:
  using Twists = std::array<Twist, kMaxRobotsPerTeam>;

  /// Sets the parameters. The game goes on.
  virtual void configure(const ControlParameters& parameters, const FieldParameters& field) = 0;
  /// Forgets the game so far.
  virtual void reset() = 0;
  /// Tells the referee's decision when it changes. While the team lines up, decide() is not called.
  virtual void set_situation(const GameSituation& /*situation*/) {}
  /// Writes the desired velocities of each player, without limits, in the order of `players`. `tracks` gives the ball
  /// and the obstacles. Called once per frame in which the robots may move.
  virtual void decide(const Tracks& tracks, const Players& players, Twists& wanted) = 0;
  /// Returns the robot's role in the last decision.
  [[nodiscard]] virtual PlayRole role_of(RobotId id) const = 0;
  /// Returns the last decision, in the strategy's coordinates; null: the strategy does not tell it.
  [[nodiscard]] virtual const PlayDecisions* decisions() const { return nullptr; }

 protected:
  // Nobody destroys a strategy through this interface, so the core needs no operator delete.
  ~Strategy() = default;
  Strategy() = default;
  Strategy(const Strategy&) = default;
  Strategy& operator=(const Strategy&) = default;
  Strategy(Strategy&&) = default;
  Strategy& operator=(Strategy&&) = default;
};

}  // namespace touchline
