#pragma once

#include <optional>

#include "core/control/control_parameters.h"
#include "core/control/player.h"
#include "core/control/referee_state.h"
#include "core/control/strategy.h"
#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"

namespace touchline {

using Places = FixedVector<Vector2, kMaxRobotsPerTeam>;

/// Places of a team while the game is stopped.
struct LineUpPlaces {
  Vector2 goalkeeper;
  std::optional<Vector2> taker;  // behind the ball, if our team takes the restart
  Places others;                 // the most important first
};

/// Computes the places for `count` robots beside goalkeeper and taker; fewer if the rules leave no room for more. The
/// other robots stand on circles around the ball, between ball and own goal first. A kick-off keeps them in their own
/// half, a penalty kick behind the ball.
void line_up_places(const GameSituation& situation, Vector2 ball, const ControlParameters& parameters,
                    const FieldParameters& field, std::size_t count, LineUpPlaces& out);

/// Drives the team to its places while the game is stopped (Permission::kLineUp): within the maximum speed, and except
/// for the robot that takes the restart, never closer to the ball than permitted, or than it is already.
class LineUp {
 public:
  void configure(const ControlParameters& parameters, const FieldParameters& field);
  /// Writes the commands in the order of `players`. A robot without a place stands. `period_s`: time until the next
  /// commands act.
  void decide(const Tracks& tracks, const Players& players, const GameSituation& situation, double period_s,
              Strategy::Twists& wanted) const;

 private:
  [[nodiscard]] Twist drive(const Player& player, Vector2 place, Vector2 ball, const Tracks& tracks,
                            double period_s) const;

  ControlParameters parameters_;
  FieldParameters field_;
};

}  // namespace touchline
