// Goals, free balls, touches, and the opponents.
#include <gtest/gtest.h>

#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

double from_center(const World& world) { return length(position(world.snapshot().ball)); }

TEST(Referee, CountsGoalsOfBothSidesAndKicksOff) {
  World world(noise_free_arena(), 1);
  world.place_ball({0.9, 0.0, 0.0}, {1.5, 0.0});
  run(world, 0.4);
  EXPECT_EQ(world.statistics().goals_own, 1U);
  EXPECT_EQ(world.statistics().goals_opponent, 0U);
  EXPECT_LT(from_center(world), 0.06);
  world.place_ball({-0.9, 0.0, 0.0}, {-1.5, 0.0});
  run(world, 0.4);
  EXPECT_EQ(world.statistics().goals_own, 1U);
  EXPECT_EQ(world.statistics().goals_opponent, 1U);
}

TEST(Referee, BallOnTheLineIsNoGoal) {
  const ArenaParameters parameters = noise_free_arena();
  World world(parameters, 1);
  world.place_ball({0.5 * parameters.field.length_m + 0.9 * parameters.ball_radius_m, 0.0, 0.0});
  run(world, 1.0);
  EXPECT_EQ(world.statistics().goals_own, 0U);
  world.place_ball({0.5 * parameters.field.length_m + 1.1 * parameters.ball_radius_m, 0.0, 0.0});
  run(world, 0.001);
  EXPECT_EQ(world.statistics().goals_own, 1U);
}

TEST(Referee, ShotBesideTheGoalBouncesBack) {
  World world(noise_free_arena(), 1);
  world.place_ball({0.8, 0.3, 0.0}, {2.0, 0.0});
  run(world, 1.0);
  EXPECT_EQ(world.statistics().goals_own, 0U);
  EXPECT_LT(world.snapshot().ball.x_m, 1.08);
}

TEST(Referee, MovesABallThatStandsStill) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.free_ball_after_s = 2.0;
  World world(parameters, 1);
  world.place_ball({0.9, 0.8, 0.0});
  world.drive(0, -0.1, 0.1);  // somebody plays
  run(world, 1.99);
  EXPECT_EQ(world.statistics().free_balls, 0U);
  run(world, 0.02);
  EXPECT_EQ(world.statistics().free_balls, 1U);
  EXPECT_LT(from_center(world), 0.06);
}

TEST(Referee, LeavesTheBallWhereSomebodyHasPutItWhileRobotsStand) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.free_ball_after_s = 1.0;
  World world(parameters, 1);
  world.place_ball({0.9, 0.8, 0.0});
  world.drive(0, 0.0, 0.0);
  run(world, 3.0);
  EXPECT_EQ(world.statistics().free_balls, 0U);
  EXPECT_EQ(world.snapshot().ball.x_m, 0.9);
}

TEST(Referee, LeavesABallThatRolls) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.free_ball_after_s = 1.0;
  parameters.physics.ball_deceleration_mps2 = parameters.physics.ball_damping_per_s = 0.0;
  World world(parameters, 1);
  world.place_ball({-1.0, 0.5, 0.0}, {0.2, 0.0});
  world.drive(0, -0.1, 0.1);
  run(world, 8.0);
  EXPECT_EQ(world.statistics().free_balls, 0U);
}

TEST(Referee, PutsTheBallBesideARobotInTheCenter) {
  ArenaParameters parameters = noise_free_arena();
  World world(parameters, 1);
  world.place(0, {0.0, 0.0, 0.3});
  world.place_ball({1.13, 0.0, 0.0});
  world.step();
  ASSERT_EQ(world.statistics().goals_own, 1U);
  EXPECT_GT(from_center(world), 0.5 * parameters.robot_side_m + parameters.ball_radius_m);
  EXPECT_LT(from_center(world), 0.3);
  const Placement before = world.snapshot().robots[0];
  run(world, 0.1);
  EXPECT_NEAR(world.snapshot().robots[0].x_m, before.x_m, 1e-9) << "the ball pushed the robot";
}

TEST(Statistics, TouchCountsOnceUntilTheRobotLeavesTheBall) {
  World world(noise_free_arena(), 1);
  world.place(0, {-0.5, 0.0, 0.0});
  world.place_ball({-0.3, 0.0, 0.0});
  EXPECT_EQ(world.statistics().touches, 0U);
  // Slowly, so that the ball stays in contact with the robot.
  world.drive(0, 0.1, 0.1);
  run(world, 3.0);
  const std::uint64_t pushed = world.statistics().touches;
  EXPECT_GE(pushed, 1U);
  EXPECT_LE(pushed, 5U);
  EXPECT_GT(world.statistics().ball_path_m, 0.05);
  world.drive(0, -0.3, -0.3);
  run(world, 0.5);
  EXPECT_EQ(world.statistics().touches, pushed);
}

TEST(Opponents, StandOrPlayAsConfiguredAndIgnorePackets) {
  for (const bool play : {false, true}) {
    ArenaParameters parameters;
    parameters.opponents = play ? Opponents::kPlay : Opponents::kStand;
    World world(parameters, 1);
    const Snapshot before = world.snapshot();
    for (int id = 0; id < 5; ++id) world.drive(id, 0.0, 0.0);
    run(world, 3.0);
    const Snapshot after = world.snapshot();
    double way = 0.0;
    for (std::size_t i = 5; i < 10; ++i) way += length(position(after.robots[i]) - position(before.robots[i]));
    if (play) {
      EXPECT_GT(way, 0.5);
    } else {
      EXPECT_LT(way, 1e-9);
      for (int id = 0; id < 5; ++id) world.drive(id, 0.3, 0.3);
      run(world, 0.5);
      EXPECT_LT(length(position(world.snapshot().robots[7]) - position(before.robots[7])), 1e-9);
    }
  }
}

TEST(Opponents, KeeperStaysAtItsGoalAndAnotherOneDrivesAtTheBall) {
  ArenaParameters parameters;
  World world(parameters, 2);
  world.place_ball({0.2, 0.6, 0.0});
  run(world, 4.0);
  EXPECT_GT(world.snapshot().robots[5].x_m, 0.9);
  EXPECT_GT(world.statistics().ball_path_m, 0.05) << "no robot touched the ball";
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
