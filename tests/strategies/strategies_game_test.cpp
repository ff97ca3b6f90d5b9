// Closed loop: each reference opponent in the arena's physics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hal/mock/random.h"
#include "tests/strategies/strategy_game.h"

namespace touchline::hal::mock {
namespace {

// Times until the attacker scores against an empty goal, from random starts; 1e9: not within `limit_s`.
std::vector<double> times_to_score(std::string_view strategy, int starts, double limit_s) {
  std::vector<double> times;
  for (int start = 0; start < starts; ++start) {
    Random random(static_cast<std::uint64_t>(start), 3);
    const Placement robot{random.uniform(-0.95, 0.95), random.uniform(-0.75, 0.75), random.uniform(-3.1, 3.1)};
    StrategyGame game(arena_of({robot}), strategy, 1);
    Vector2 ball = {random.uniform(-0.8, 0.8), random.uniform(-0.7, 0.7)};
    game.world().place_ball({ball.x, ball.y, 0.0});
    game.placed();
    while (game.statistics().goals_own == 0 && game.time_s() < limit_s) game.play_frame();
    times.push_back(game.statistics().goals_own > 0 ? game.time_s() : 1e9);
    if (game.statistics().goals_opponent > 0) times.back() = 2e9;
    if (getenv("SHOW")) printf("%s %d: %.2f\n", std::string(strategy).c_str(), start, times.back());
  }
  std::sort(times.begin(), times.end());
  return times;
}

TEST(UnivectorGame, TheAttackerScoresAgainstAnEmptyGoal) {
  for (const char* name : {"univector", "univector-fast", "pusher", "wall"}) {
    const auto times = times_to_score(name, 20, 20.0);
    printf("%s median %.2f last %.2f\n", name, times[10], times.back());
  }
}

}  // namespace
}  // namespace touchline::hal::mock
