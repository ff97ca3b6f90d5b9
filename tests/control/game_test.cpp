// The loop closed: five robots and a ball in a small simulation.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/control/controller.h"
#include "tests/control/small_world.h"

namespace touchline {
namespace {

constexpr double kFrame = 0.016;

SmallWorld kick_off(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-1.0, 1.0);
  SmallWorld world;
  for (int i = 0; i < 5; ++i) {
    SmallWorld::Robot robot;
    robot.id = static_cast<RobotId>(i);
    robot.position = {-0.2 - 0.19 * i, 0.6 * along(random)};
    robot.heading = 3.1 * along(random);
    world.robots.push_back(robot);
  }
  world.ball = {0.5 * along(random), 0.6 * along(random)};
  return world;
}

struct Game {
  int goals = 0, own_goals = 0;
  double contact_s = 0.0, first_goal_s = 0.0, ball_progress = 0.0;
  std::uint64_t hash = 14695981039346656037ull;
};

Game play(unsigned seed, double duration_s, SmallWorld world) {
  std::mt19937 noise(seed);
  Controller controller;
  EXPECT_TRUE(controller.configure({}, world.field).ok());
  Game game;
  const double begin = world.ball.x;
  Commands commands;
  while (world.time_s < duration_s) {
    controller.decide(world.tracks(&noise, 0.001), false, commands);
    world.obey(commands);
    world.advance(kFrame);
    if (world.goals > 0 && game.first_goal_s == 0.0) game.first_goal_s = world.time_s;
    if (world.goals == 0) game.ball_progress = std::max(game.ball_progress, world.ball.x - begin);
    for (const RobotCommand& command : commands.robots) {
      for (const float value : {command.twist.v_mps, command.twist.w_radps, command.wheels.left_mps}) {
        EXPECT_TRUE(std::isfinite(value));
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        game.hash = (game.hash ^ bits) * 1099511628211ull;
      }
    }
  }
  game.goals = world.goals;
  game.own_goals = world.own_goals;
  game.contact_s = world.robot_contact_s;
  return game;
}

TEST(Game, GoalsAreScoredFromEveryKickOff) {
  int goals = 0, own_goals = 0;
  double contact = 0.0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Game game = play(seed, 40.0, kick_off(seed));
    std::printf("seed %u: %d goals, first after %.1f s, %d own goals, %.2f s of pushing each other\n", seed, game.goals,
                game.first_goal_s, game.own_goals, game.contact_s);
    EXPECT_GE(game.goals, 1) << seed;
    goals += game.goals;
    own_goals += game.own_goals;
    contact += game.contact_s;
  }
  std::printf("total %d goals, %d own goals, contact %.2f s\n", goals, own_goals, contact);
  EXPECT_GE(goals, 12 * 3);
  EXPECT_EQ(own_goals, 0);
}

}  // namespace
}  // namespace touchline
