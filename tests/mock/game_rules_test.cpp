// Goals, free balls, touches and the other statistics.
#include <gtest/gtest.h>

#include "hal/mock/game.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

double from_center(const Game& game) { return length(position(game.world().snapshot().ball)); }

TEST(Referee, CountsGoalsOfBothSidesAndKicksOff) {
  Game game(noise_free_arena(), RadioSettings{}, 1);
  game.rules().place_ball({0.9, 0.0, 0.0}, {1.5, 0.0});
  run(game, 0.4);
  EXPECT_EQ(game.statistics().goals_own, 1U);
  EXPECT_EQ(game.statistics().goals_opponent, 0U);
  EXPECT_LT(from_center(game), 0.06);
  game.rules().place_ball({-0.9, 0.0, 0.0}, {-1.5, 0.0});
  run(game, 0.4);
  EXPECT_EQ(game.statistics().goals_own, 1U);
  EXPECT_EQ(game.statistics().goals_opponent, 1U);
}

TEST(Referee, BallOnTheLineIsNoGoal) {
  const ArenaParameters parameters = noise_free_arena();
  Game game(parameters, RadioSettings{}, 1);
  game.rules().place_ball({0.5 * parameters.field.length_m + 0.9 * parameters.ball_radius_m, 0.0, 0.0});
  run(game, 1.0);
  EXPECT_EQ(game.statistics().goals_own, 0U);
  game.rules().place_ball({0.5 * parameters.field.length_m + 1.1 * parameters.ball_radius_m, 0.0, 0.0});
  run(game, 0.001);
  EXPECT_EQ(game.statistics().goals_own, 1U);
}

TEST(Referee, ShotBesideTheGoalBouncesBack) {
  Game game(noise_free_arena(), RadioSettings{}, 1);
  game.rules().place_ball({0.8, 0.3, 0.0}, {2.0, 0.0});
  run(game, 1.0);
  EXPECT_EQ(game.statistics().goals_own, 0U);
  EXPECT_LT(game.world().snapshot().ball.x_m, 1.08);
}

TEST(Referee, MovesABallThatStandsStill) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.free_ball_after_s = 2.0;
  Game game(parameters, RadioSettings{}, 1);
  game.rules().place_ball({0.9, 0.8, 0.0});
  game.world().drive(0, -0.1, 0.1);  // somebody plays
  run(game, 1.99);
  EXPECT_EQ(game.statistics().free_balls, 0U);
  run(game, 0.02);
  EXPECT_EQ(game.statistics().free_balls, 1U);
  EXPECT_LT(from_center(game), 0.06);
}

TEST(Referee, LeavesTheBallWhereSomebodyHasPutItWhileRobotsStand) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.free_ball_after_s = 1.0;
  Game game(parameters, RadioSettings{}, 1);
  game.rules().place_ball({0.9, 0.8, 0.0});
  game.world().drive(0, 0.0, 0.0);
  run(game, 3.0);
  EXPECT_EQ(game.statistics().free_balls, 0U);
  EXPECT_EQ(game.world().snapshot().ball.x_m, 0.9);
}

TEST(Referee, LeavesABallThatRolls) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.free_ball_after_s = 1.0;
  parameters.physics.ball_deceleration_mps2 = parameters.physics.ball_damping_per_s = 0.0;
  Game game(parameters, RadioSettings{}, 1);
  game.rules().place_ball({-1.0, 0.5, 0.0}, {0.2, 0.0});
  game.world().drive(0, -0.1, 0.1);
  run(game, 8.0);
  EXPECT_EQ(game.statistics().free_balls, 0U);
}

TEST(Referee, PutsTheBallBesideARobotInTheCenter) {
  ArenaParameters parameters = noise_free_arena();
  Game game(parameters, RadioSettings{}, 1);
  game.world().place(0, {0.0, 0.0, 0.3});
  game.rules().place_ball({1.13, 0.0, 0.0});
  game.step();
  ASSERT_EQ(game.statistics().goals_own, 1U);
  EXPECT_GT(from_center(game), 0.5 * parameters.robot_side_m + parameters.ball_radius_m);
  EXPECT_LT(from_center(game), 0.3);
  const Placement before = game.world().snapshot().robots[0];
  run(game, 0.1);
  EXPECT_NEAR(game.world().snapshot().robots[0].x_m, before.x_m, 1e-9) << "the ball pushed the robot";
}

TEST(Statistics, TouchCountsOnceUntilTheRobotLeavesTheBall) {
  Game game(noise_free_arena(), RadioSettings{}, 1);
  game.world().place(0, {-0.5, 0.0, 0.0});
  game.rules().place_ball({-0.3, 0.0, 0.0});
  EXPECT_EQ(game.statistics().touches[0], 0U);
  // Slowly, so that the ball stays in contact with the robot.
  game.world().drive(0, 0.1, 0.1);
  run(game, 3.0);
  const std::uint64_t pushed = game.statistics().touches[0];
  EXPECT_GE(pushed, 1U);
  EXPECT_LE(pushed, 5U);
  EXPECT_GT(game.statistics().ball_path_m, 0.05);
  game.world().drive(0, -0.3, -0.3);
  run(game, 0.5);
  EXPECT_EQ(game.statistics().touches[0], pushed);
}

// Equal sides that struggle for the ball must not have it by the order of the robots.
TEST(Statistics, ABallThatBothTouchStaysWithTheSideThatHadIt) {
  for (const double first : {-1.0, 1.0}) {
    ArenaParameters parameters = noise_free_arena();
    const double reach = 0.5 * parameters.robot_side_m + parameters.ball_radius_m;
    // The first robot stands at the ball; the other one comes from the other side and stays there.
    parameters.robot = {{Side::kOwn, 0, first < 0.0 ? -reach : -0.3, 0.0, 0.0, {"red"}},
                        {Side::kOpponent, 0, first < 0.0 ? 0.3 : reach, 0.0, 3.14159265, {"red"}}};
    Game game(parameters, RadioSettings{}, 1);
    game.rules().place_ball({});
    const Side comes = first < 0.0 ? Side::kOpponent : Side::kOwn;
    game.world().drive(0, 0.3, 0.3, comes);
    run(game, 2.0);
    const std::size_t had = first < 0.0 ? 0 : 1;
    ASSERT_GT(game.statistics().touches[1 - had], 0U) << "both must touch the ball";
    EXPECT_GT(game.statistics().possession_s[had], 1.9) << first;
    EXPECT_LT(game.statistics().possession_s[1 - had], 0.1) << first;
  }
}

TEST(Referee, TellsThatRobotsMustStandAfterTheyWerePlaced) {
  ArenaParameters parameters = noise_free_arena();
  EXPECT_FALSE(Game(parameters, RadioSettings{}, 1).rules().referee().has_value()) << "nobody was placed";
  parameters.robots_return = true;
  Game game(parameters, RadioSettings{}, 1);
  ASSERT_TRUE(game.rules().referee().has_value());
  EXPECT_EQ(permission_in(*game.rules().referee()), Permission::kStand);
  run(game, 1.0);
  EXPECT_FALSE(game.rules().referee().has_value());
}

TEST(Statistics, CountPossessionContactsAndStandingOfEachSide) {
  ArenaParameters parameters = noise_free_arena();
  parameters.robot.push_back({Side::kOwn, 1, -0.3, 0.5, 0.0, {"red"}});
  parameters.robot.push_back({Side::kOpponent, 0, 0.5, -0.5, 0.0, {"red"}});
  Game game(parameters, RadioSettings{}, 1);
  game.rules().place_ball({-0.45, 0.0, 0.0});
  game.world().drive(0, 0.3, 0.3);
  run(game, 0.6);
  EXPECT_GT(game.statistics().possession_s[0], 0.1);
  EXPECT_EQ(game.statistics().possession_s[1], 0.0);
  EXPECT_EQ(game.statistics().touches[1], 0U);
  // The ball stands beside the wall while a robot turns elsewhere.
  game.rules().place_ball({0.8, 0.85, 0.0});
  game.world().place(1, {-0.5, 0.5, 0.0});
  game.world().drive(0, -0.1, 0.1);
  run(game, GameStatistics::kStandingS - 0.1);
  EXPECT_EQ(game.statistics().ball_stood_s, 0.0);
  run(game, 1.1);
  EXPECT_NEAR(game.statistics().ball_stood_s, GameStatistics::kStandingS + 1.0, 0.01);
  // Two own robots touch once, then an own and an opponent's robot.
  EXPECT_EQ(game.statistics().contacts[0], 0U);
  game.world().place(0, {-0.6, 0.5, 0.0});
  game.world().drive(0, 0.3, 0.3);
  run(game, 0.2);
  EXPECT_GE(game.statistics().contacts[0], 1U);
  EXPECT_EQ(game.statistics().mixed_contacts, 0U);
  game.world().place(0, {0.4, -0.5, 0.0});
  game.world().drive(0, 0.3, 0.3);
  run(game, 0.2);
  EXPECT_GE(game.statistics().mixed_contacts, 1U);
}

TEST(World, IgnoresAnUnknownId) {
  World world(noise_free_arena(), 1), other(noise_free_arena(), 1);
  world.drive(5, 1.0, 1.0);
  run(world, 0.5);
  run(other, 0.5);
  EXPECT_EQ(world.hash(), other.hash());
}

}  // namespace
}  // namespace touchline::hal::mock
