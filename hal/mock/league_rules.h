#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/control/referee_state.h"
#include "core/geometry/vector2.h"
#include "hal/fnv1a.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

constexpr Side other_side(Side side) { return side == Side::kOwn ? Side::kOpponent : Side::kOwn; }

/// A restart that the referee orders.
struct RestartOrder {
  Restart restart = Restart::kNone;
  std::optional<Side> side;     // takes the restart; nullopt: nobody, it is a free ball
  std::optional<Side> foul_of;  // committed a foul; nullopt: there was none
  Vector2 ball;                 // place of the ball
};

/// Judges a game as the rules of MiroSot (FIRA, middle league) and of VSSS (CBR) do:
/// - A ball that stands for PhysicsParameters::free_ball_after_s outside of the goal areas: free ball at the mark of
///   its quadrant.
/// - More than one defender in its own goal area while the ball is there: penalty kick. More than one attacker: goal
///   kick.
/// - The ball stays in a goal area for as long: goal kick if an attacker is in it, else penalty kick, because the
///   goalkeeper does not clear it.
/// Nothing is allocated after construction.
class LeagueRules {
 public:
  explicit LeagueRules(const ArenaParameters& parameters);

  /// Exchanges the sides of the teams.
  void exchange_sides() { exchanged_ = !exchanged_; }
  [[nodiscard]] bool sides_exchanged() const { return exchanged_; }
  /// Returns 1.0 if this side attacks towards positive x, else -1.0.
  [[nodiscard]] double direction_of(Side side) const { return (side == Side::kOwn) != exchanged_ ? 1.0 : -1.0; }

  /// Starts all clocks anew, because the ball was placed.
  void restart() { areas_ = {}; }
  /// Judges a step in which the ball is in play. `still_s`: time in which the ball has not moved.
  std::optional<RestartOrder> judge(const World& world, double still_s);
  [[nodiscard]] static RestartOrder kick_off(Side side) { return {Restart::kKickOff, side, std::nullopt, {}}; }

  /// Writes where robots stand for this restart: robots in a legal place of `from` remain there, the others move as
  /// little as necessary. If `fixes`, the robots that take part in the restart, and the goalkeepers that must, get the
  /// places of the rules, which are beside the ball or on the goal line; otherwise they choose their own.
  void place(const RestartOrder& order, const World& world, const Snapshot& from, bool fixes, Snapshot& out) const;

  void add_to(Fnv1a& hash) const;

 private:
  /// What happens in the goal area of a side.
  struct Area {
    double ball_s = 0.0, defenders_s = 0.0, attackers_s = 0.0;
  };
  struct Players {
    std::optional<std::size_t> goalkeeper, taker;
  };
  class Placing;

  [[nodiscard]] bool in_goal_area(Vector2 in_own_coordinates) const;
  std::optional<RestartOrder> judge_area(const World& world, Side defender);
  [[nodiscard]] RestartOrder free_ball(Vector2 ball) const;
  [[nodiscard]] RestartOrder penalty(Side foul_of) const;
  [[nodiscard]] RestartOrder goal_kick(Side foul_of, Vector2 ball) const;
  [[nodiscard]] Players players_of(Side side, const World& world, const Snapshot& from,
                                   const RestartOrder& order) const;
  // Both in the coordinates of the robot's side, which attacks towards positive x.
  [[nodiscard]] std::optional<Placement> fixed_place(const RestartOrder& order, Side side, bool is_goalkeeper,
                                                     bool is_taker) const;
  [[nodiscard]] bool is_legal(const RestartOrder& order, Side side, bool is_goalkeeper, bool is_taker,
                              Vector2 place) const;
  [[nodiscard]] bool is_on_field(Vector2 place) const;

  const ArenaField field_;
  const RulesParameters rules_;
  const double radius_m_;  // of the circle around a robot
  const double reach_m_;   // distance of the centers of robot and ball that do not touch, whatever the heading
  const double limit_s_;
  bool exchanged_ = false;
  std::array<Area, 2> areas_{};  // by Side
};

}  // namespace touchline::hal::mock
