// Closed loop: each reference opponent in the arena's physics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "hal/mock/random.h"
#include "tests/results.h"
#include "tests/strategies/strategy_game.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::hal::mock {
namespace {

constexpr const char* kMoving[] = {"follow", "univector", "univector-fast", "pusher", "wall"};
const std::vector<Placement> kFive{
    {-1.00, 0.0, 1.5}, {-0.55, 0.45, 0.0}, {-0.55, -0.45, 0.0}, {-0.30, 0.15, 0.0}, {-0.75, -0.1, 0.0}};

// Times in s until the attacker scores against an empty goal, from random starts, in ascending order. A time-out and
// an own goal count as `limit_s`.
std::vector<double> times_to_score(std::string_view strategy, std::uint64_t starts, double limit_s) {
  std::vector<double> times;
  for (std::uint64_t start = 0; start < starts; ++start) {
    Random random(start, 3);
    const Placement robot{random.uniform(-0.95, 0.95), random.uniform(-0.75, 0.75), random.uniform(-3.1, 3.1)};
    StrategyGame game(arena_of({robot}), strategy);
    const Placement ball{random.uniform(-0.8, 0.8), random.uniform(-0.7, 0.7), 0.0};
    game.place_ball(ball);
    const GameStatistics& score = game.statistics();
    while (score.goals_own + score.goals_opponent == 0 && game.time_s() < limit_s) game.play_frame();
    times.push_back(score.goals_own > 0 ? game.time_s() : limit_s);
  }
  std::sort(times.begin(), times.end());
  return times;
}

struct Attack {
  const char* strategy;
  double median_low_s, median_high_s, seventeenth_s;
};
class StrategyAttack : public testing::TestWithParam<Attack> {};

TEST_P(StrategyAttack, ScoresAgainstAnEmptyGoalFromAnywhere) {
  const std::vector<double> times = times_to_score(GetParam().strategy, 20, 20.0);
  EXPECT_GT(times[10], GetParam().median_low_s);
  EXPECT_LT(times[10], GetParam().median_high_s);
  // A ball that rolls along the end wall past the goal takes longer, and so does a fast robot whose tires slide.
  EXPECT_LT(times[16], GetParam().seventeenth_s) << times[17] << " " << times[18];
}

INSTANTIATE_TEST_SUITE_P(All, StrategyAttack,
                         testing::Values(Attack{"univector", 2.0, 5.0, 8.0}, Attack{"univector-fast", 1.2, 5.0, 15.0},
                                         Attack{"pusher", 1.5, 5.0, 12.0}, Attack{"wall", 2.0, 5.0, 8.0}),
                         [](const auto& test) {
                           std::string name = test.param.strategy;
                           std::erase(name, '-');
                           return name;
                         });

// Number of saves of 10 straight shots at the goal, whose goalkeeper stands in its middle.
int saves(std::string_view strategy, double speed_mps) {
  int saved = 0;
  for (int shot = 0; shot < 10; ++shot) {
    StrategyGame game(arena_of({{-1.02, 0.0, 1.5}, {1.0, 0.8, 0.0}}), strategy);
    const double y = -0.18 + 0.04 * shot;
    game.place_ball({0.0, y, 0.0}, {-speed_mps, 0.0});
    while (game.time_s() < 4.0 && game.statistics().goals_opponent == 0) game.play_frame();
    saved += game.statistics().goals_opponent == 0 ? 1 : 0;
  }
  return saved;
}

TEST(StrategyGoalkeeper, StopsStraightShots) {
  for (const char* strategy : kMoving) EXPECT_EQ(saves(strategy, 1.0), 10) << strategy;
  EXPECT_LE(saves("stand", 1.0), 4) << "otherwise the shots do not need a goalkeeper";
}

TEST(StrategyGame, TheFollowerReachesTheBall) {
  for (std::uint64_t start = 0; start < 10; ++start) {
    Random random(start, 4);
    StrategyGame game(arena_of({kFive[0], {random.uniform(-0.9, 0.9), random.uniform(-0.8, 0.8), 1.0}}), "follow");
    const Placement ball{random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.0};
    game.place_ball(ball);
    // The field's diagonal at 0.35 m/s, and a turn.
    while (game.time_s() < 9.0 && game.statistics().touches[0] == 0) game.play_frame();
    EXPECT_GT(game.statistics().touches[0], 0U) << start;
  }
}

// Distance of a point from the segment between two others.
double distance_from_segment(Vector2 p, Vector2 from, Vector2 to) {
  const Vector2 way = to - from;
  const double along = std::clamp(dot(p - from, way) / dot(way, way), 0.0, 1.0);
  return distance(p, from + along * way);
}

TEST(StrategyGame, TheWallStandsBetweenBallAndGoal) {
  for (const double y : {-0.6, -0.3, 0.0, 0.3, 0.6}) {
    StrategyGame game(arena_of(kFive), "wall");
    game.place_ball({0.9, y, 0.0});
    // Robot 3 is the nearest to the ball and needs more time to reach it.
    while (game.time_s() < 1.6) game.play_frame();
    const Vector2 goal{-1.1, 0.0};
    int blocking = 0;
    for (const std::size_t robot : {1U, 2U, 4U}) {
      EXPECT_NEAR(distance(game.robot(robot), goal), 0.42, 0.12) << y << " " << robot;
      blocking += distance_from_segment(game.robot(robot), goal, game.ball()) < 0.06 ? 1 : 0;
    }
    EXPECT_GE(blocking, 1) << y;
    const double gap = 0.0427 + 0.075;
    EXPECT_LT(distance(game.robot(1), game.robot(4)), gap) << y;
    EXPECT_LT(distance(game.robot(2), game.robot(4)), gap) << y;
  }
}

// Longest time in s for which a robot did not move although it was commanded to.
double longest_stall(StrategyGame& game, double duration_s) {
  struct Still {
    Placement at;
    double since_s = 0.0;
  };
  std::array<Still, 5> still{};
  double longest = 0.0;
  while (game.time_s() < duration_s) {
    game.play_frame();
    for (const RobotCommand& robot : game.commands().robots) {
      const auto id = static_cast<std::size_t>(robot.id);
      const Placement now = game.world().snapshot().robots[id];
      Still& s = still[id];
      const bool moved = std::hypot(now.x_m - s.at.x_m, now.y_m - s.at.y_m) > 0.02 ||
                         std::abs(wrap_angle(now.theta_rad - s.at.theta_rad)) > 0.3;
      const bool commanded = std::abs(robot.twist.v_mps) > 0.15f || std::abs(robot.twist.w_radps) > 1.5f;
      if (moved || !commanded) s = {now, game.time_s()};
      longest = std::max(longest, game.time_s() - s.since_s);
    }
  }
  return longest;
}

TEST(StrategyGame, NobodyDrivesIntoAWallOrARobotForLong) {
  for (const char* strategy : kMoving) {
    StrategyGame game(arena_of(kFive), strategy);
    // Two attempts to get free: 0.5 s until a jam is noticed and 0.3 s of escape each, and the first motion.
    EXPECT_LT(longest_stall(game, 20.0), 2.0) << strategy;
  }
}

TEST(StrategyGame, TeamsOfAnySizeScoreOnAnyField) {
  struct Size {
    double length_m, width_m, goal_width_m;
    int robots;
  };
  // VSSS 3:3, VSSS 5:5, MiroSot 11:11.
  for (const Size& size : {Size{1.5, 1.3, 0.4, 3}, Size{2.2, 1.8, 0.4, 5}, Size{4.0, 2.8, 0.6, 11}}) {
    std::vector<Placement> robots;
    for (int i = 0; i < size.robots; ++i) {
      robots.push_back({-0.4 * size.length_m + 0.1 * (i % 4), 0.14 * (i - size.robots / 2), 0.0});
    }
    ArenaParameters arena = arena_of(robots);
    arena.field.length_m = size.length_m;
    arena.field.width_m = size.width_m;
    arena.field.goal_width_m = size.goal_width_m;
    for (const char* strategy : {"univector", "univector-fast", "pusher", "wall"}) {
      StrategyGame game(arena, strategy);
      while (game.statistics().goals_own == 0 && game.time_s() < 30.0) game.play_frame();
      EXPECT_GE(game.statistics().goals_own, 1U) << strategy << " " << size.robots;
      EXPECT_LE(game.statistics().goals_opponent, 1U) << strategy << " " << size.robots;
    }
  }
}

std::uint64_t hash_of(std::string_view strategy, std::uint64_t seed) {
  StrategyGame game(arena_of(kFive), strategy, seed);
  while (game.time_s() < 6.0) game.play_frame();
  return game.world().hash();
}

TEST(StrategyGame, TheSeedRepeatsAGame) {
  for (const char* strategy : kMoving) EXPECT_EQ(hash_of(strategy, 1), hash_of(strategy, 1)) << strategy;
  EXPECT_NE(hash_of("follow", 1), hash_of("follow", 2)) << "it draws random places";
}

TEST(StrategyGame, DecisionsDoNotAllocate) {
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "the sanitizer's allocator does not count";
  for (const char* strategy : kMoving) {
    StrategyGame game(arena_of(kFive), strategy);
    const std::uint64_t before = latency::allocations_of_this_thread();
    while (game.time_s() < 0.5) game.play_frame();
    EXPECT_EQ(latency::allocations_of_this_thread(), before) << strategy;
  }
}

}  // namespace
}  // namespace touchline::hal::mock
