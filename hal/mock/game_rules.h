#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/control/referee_state.h"
#include "core/geometry/vector2.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/league_rules.h"
#include "hal/mock/random.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// What happened in a game. The index of an array is the number of a Side.
struct GameStatistics {
  // The ball stands if it has stayed at a place for so long.
  static constexpr double kStandingS = 3.0;

  std::array<std::uint64_t, 2> touches{};  // number of times that a robot of the side began to touch the ball
  double ball_path_m = 0.0;
  std::uint32_t goals_own = 0, goals_opponent = 0;  // goals scored by each team
  std::uint32_t free_balls = 0;
  // Time in which the side was the last to touch the ball. While both touch it, the side that had it keeps it.
  std::array<double, 2> possession_s{};
  double ball_stood_s = 0.0;                // time in which the ball stood, kStandingS included
  std::array<std::uint64_t, 2> contacts{};  // number of times that two robots of the side began to touch each other
  std::uint64_t mixed_contacts = 0;         // the same for robots of different sides
  std::array<std::uint32_t, 2> fouls{};     // committed by the side
  std::array<std::uint32_t, 6> restarts{};  // by Restart; kNone: restarts near the center by the simple rules
};

/// The arena's referee: counts goals, lets the game go on after a goal, a foul or a jam (RulesParameters), exchanges
/// sides, and keeps the statistics. Nothing is allocated after construction.
class GameRules {
 public:
  /// Puts the ball near the center. `world` must outlive this object.
  GameRules(const ArenaParameters& parameters, World& world, std::uint64_t seed);

  /// Judges the world after each of its steps.
  void update();
  /// Begins the game anew, with other random numbers: the statistics are zero, and the ball is near the center.
  void restart(std::uint64_t seed);
  /// Puts the ball somewhere else; it then waits there for as long as after a kick-off.
  void place_ball(const Placement& placement, Vector2 velocity_mps = {});
  /// Returns whether all robots must stand: for a second after they were placed.
  [[nodiscard]] bool is_stopped() const { return stopped_steps_ > 0; }
  /// Returns the referee's decision as a side sees it. By the simple rules there is no referee.
  [[nodiscard]] GameSituation situation(Side side) const;
  /// Returns whether the own side attacks towards negative x.
  [[nodiscard]] bool sides_exchanged() const { return league_.sides_exchanged(); }
  /// Returns the same as a referee tells it to the own team, also that robots must stand; its time of reception is not
  /// set. nullopt: there is no referee, and robots may move.
  [[nodiscard]] std::optional<RefereeState> referee() const;
  /// Returns the number of restarts so far.
  [[nodiscard]] std::uint32_t restarts() const { return restarts_; }
  /// Puts a robot somewhere else, also while the game is stopped. By the simple rules it returns to its place at the
  /// start of the game after the next goal.
  void place_robot(std::size_t robot, const Placement& placement);
  /// Returns how often the rules have put robots elsewhere.
  [[nodiscard]] std::uint32_t placements() const { return placements_; }
  [[nodiscard]] const GameStatistics& statistics() const { return statistics_; }
  /// FNV-1a hash of world, rules and statistics, including the state of the random generator.
  [[nodiscard]] std::uint64_t hash() const;

 private:
  void begin();
  void count_touches();
  void count_contacts();
  void watch_goals();
  void watch_standing();
  void watch_line_up();
  void end_half();
  // Lets the game go on after a goal that `conceded`.
  void kick_off(Side conceded);
  void restart_near_center();
  // `by_hand`: people place the robots, even if they could drive.
  void order(const RestartOrder& order, bool by_hand);
  // Puts the robots into held_ and stops the game.
  void put_robots();
  void hold_places_of_start();
  void hold_robots();

  const double goal_line_m_, reach_m_, free_ball_after_s_;
  const Vector2 quarter_;  // half of the field's half length and half width
  const bool returns_robots_;
  const RulesParameters rules_;
  World& world_;
  const Snapshot start_;
  LeagueRules league_;
  Random random_;
  GameStatistics statistics_;
  std::optional<Side> possession_;
  std::uint32_t touches_ball_ = 0;  // bits of the robots
  std::uint64_t steps_ = 0;
  std::uint32_t restarts_ = 0, placements_ = 0;
  Snapshot held_;          // where robots are held while the game is stopped
  int stopped_steps_ = 0;  // until the game goes on
  // By a league's rules: the last restart, whether nobody has touched the ball since, and the time for which robots
  // have been driving to their places; negative: they are not.
  RestartOrder order_;
  bool is_untouched_ = false;
  double line_up_s_ = -1.0;
  Snapshot line_up_before_;
  Side first_kick_off_ = Side::kOwn;
  std::uint32_t half_ = 1;
  // By the numbers of two robots, the larger one first: the last step in which they touched; 0: never.
  std::array<std::array<std::uint64_t, kMaxRobots>, kMaxRobots> last_contact_{};
  double still_s_ = 0.0;
  Vector2 still_at_, ball_before_;
};

}  // namespace touchline::hal::mock
