#include "tools/programs/simulate/game_series.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "hal/mock/turned_placement.h"

namespace touchline::simulate {

using hal::mock::ArenaParameters;
using hal::mock::ArenaRobot;
using hal::mock::Side;

ArenaParameters fair_arena(const config::Configuration& configuration, int robots) {
  ArenaParameters arena = configuration.board.arena;
  std::vector<ArenaRobot> own, opponents;
  for (const ArenaRobot& robot : arena.robot) (robot.team == Side::kOwn ? own : opponents).push_back(robot);
  const std::size_t wanted = robots > 0 ? static_cast<std::size_t>(robots) : own.size();
  own.resize(std::min(own.size(), wanted));
  opponents.resize(std::min(opponents.size(), own.size()));
  for (std::size_t i = 0; i < opponents.size(); ++i) {
    const hal::mock::Placement place = hal::mock::turned({own[i].x_m, own[i].y_m, own[i].theta_rad});
    opponents[i].x_m = place.x_m;
    opponents[i].y_m = place.y_m;
    opponents[i].theta_rad = place.theta_rad;
  }
  arena.robot = std::move(own);
  arena.robot.insert(arena.robot.end(), opponents.begin(), opponents.end());
  arena.robots_return = true;
  return arena;
}

Result<GameResult> play_game(const ArenaParameters& arena, const Team& own, const Team& opponent, std::uint64_t seed,
                             double duration_s, OwnView view) {
  TOUCHLINE_TRY_ASSIGN(const auto played, TeamGame::begin(arena, own, opponent, seed, view));
  TOUCHLINE_TRY(played->advance_to(duration_s));
  return GameResult{seed, played->game().hash(), played->game().statistics()};
}

Result<Series> play_series(const ArenaParameters& arena, const Team& own, const Team& opponent,
                           const SeriesSettings& settings, const std::function<void(int)>& progress) {
  Series series;
  series.own = own.name;
  series.opponent = opponent.name;
  series.duration_s = settings.duration_s;
  series.view = settings.view;
  series.games.resize(static_cast<std::size_t>(settings.seeds));
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  int done = 0;
  std::optional<Error> error;
  const auto begin = std::chrono::steady_clock::now();
  const auto work = [&] {
    for (std::size_t i = next++; i < series.games.size(); i = next++) {
      Result<GameResult> result =
          play_game(arena, own, opponent, settings.first_seed + i, settings.duration_s, settings.view);
      const std::scoped_lock lock(mutex);
      if (!result.ok()) {
        error = std::move(result).error();
        next = series.games.size();
        return;
      }
      series.games[i] = result.value();
      ++done;
      if (progress) progress(done);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < std::min(settings.jobs, settings.seeds); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) return *std::move(error);
  series.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return series;
}

}  // namespace touchline::simulate
