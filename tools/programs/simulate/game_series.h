#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hal/mock/game_rules.h"
#include "hal/result.h"
#include "tools/programs/simulate/team.h"
#include "tools/programs/simulate/team_game.h"

namespace touchline::simulate {

/// The games of a series: one for each seed from `first_seed` on.
struct SeriesSettings {
  std::uint64_t first_seed = 1;
  int seeds = 20;
  double duration_s = 300.0;
  int jobs = 1;  // games that are played at the same time
  OwnView view = OwnView::kSightings;
};

struct GameResult {
  std::uint64_t seed = 0;
  std::uint64_t hash = 0;  // of the game's final state
  hal::mock::GameStatistics statistics;

  [[nodiscard]] int goals_own() const { return static_cast<int>(statistics.goals_own); }
  [[nodiscard]] int goals_opponent() const { return static_cast<int>(statistics.goals_opponent); }
  [[nodiscard]] int difference() const { return goals_own() - goals_opponent(); }
};

struct Series {
  std::string own, opponent;
  double duration_s = 0.0;  // of each game
  OwnView view = OwnView::kSightings;
  std::vector<GameResult> games;
  double wall_s = 0.0;  // time that the series took
};

/// Returns the arena of a fair game: robots stand where the board file puts the own ones, the opponents turned by 180
/// degrees, and return there after each goal. `robots`: robots of each side, the first ones of the board file; 0: all.
hal::mock::ArenaParameters fair_arena(const config::Configuration& configuration, int robots);

/// Plays one game. The same arguments give the same result bit for bit. Errors of TeamGame.
Result<GameResult> play_game(const hal::mock::ArenaParameters& arena, const Team& own, const Team& opponent,
                             std::uint64_t seed, double duration_s, OwnView view);

/// Plays all games. `progress` is called after each game with the number of games that have ended, on one thread at a
/// time. Errors of play_game().
Result<Series> play_series(const hal::mock::ArenaParameters& arena, const Team& own, const Team& opponent,
                           const SeriesSettings& settings, const std::function<void(int)>& progress);

}  // namespace touchline::simulate
