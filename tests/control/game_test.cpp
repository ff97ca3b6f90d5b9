// Closed loop: five robots and a ball in the arena's physics.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/control/controller.h"
#include "tests/control/arena_world.h"

namespace touchline {
namespace {

ArenaWorld kick_off(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-1.0, 1.0);
  ArenaWorld world;
  for (int i = 0; i < 5; ++i) {
    ArenaWorld::Robot robot;
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
  double contact_s = 0.0, first_goal_s = 0.0;
  double moved_s = -1.0;  // when the ball was first 0.2 m from where it began; negative: never
  std::uint64_t hash = 14695981039346656037ull;
};

Game play(unsigned seed, double duration_s, ArenaWorld world) {
  std::mt19937 noise(seed);
  Controller controller;
  EXPECT_TRUE(controller.configure({}, world.field).ok());
  Game game;
  const Vector2 begin = world.ball;
  Commands commands;
  while (world.time_s < duration_s) {
    controller.decide(world.tracks(&noise, 0.001), false, commands);
    world.obey(commands);
    world.advance(kFrame);
    if (world.goals > 0 && game.first_goal_s == 0.0) game.first_goal_s = world.time_s;
    if (game.moved_s < 0.0 && distance(world.ball, begin) > 0.2) game.moved_s = world.time_s;
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
  // 164 with the default parameters. Occasional own goals happen when the ball bounces off a group of robots.
  EXPECT_GE(goals, 110);
  EXPECT_LE(goals, 220);
  EXPECT_LE(own_goals, 2);
  // The limit is for 40 minutes of robot time.
  EXPECT_LT(contact, 8.0);
}

TEST(Game, IsBitIdenticalForTheSameSeed) {
  EXPECT_EQ(play(4, 15.0, kick_off(4)).hash, play(4, 15.0, kick_off(4)).hash);
  EXPECT_NE(play(4, 15.0, kick_off(4)).hash, play(5, 15.0, kick_off(5)).hash)
      << "otherwise the hash does not depend on the game";
}

TEST(Game, AvoidsOpponents) {
  int goals = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    ArenaWorld world = kick_off(seed);
    for (int i = 0; i < 4; ++i) {
      ArenaWorld::Robot robot;
      robot.team = Team::kOpponent;
      robot.position = {0.25 + 0.2 * i, i % 2 == 0 ? 0.35 : -0.35};
      robot.jammed = true;
      world.robots.push_back(robot);
    }
    goals += play(seed, 40.0, world).goals;
  }
  std::printf("%d goals with stationary opponents\n", goals);
  // 40 with the default parameters.
  EXPECT_GE(goals, 20);
  EXPECT_LE(goals, 80);
}

TEST(Game, MovesTheBallOutOfCornersAndAwayFromWalls) {
  int scored = 0, moved = 0;
  for (const Vector2 corner : {Vector2{1.04, 0.85}, Vector2{1.04, -0.85}, Vector2{-1.04, 0.85}, Vector2{-1.04, -0.85},
                               Vector2{0.0, 0.87}, Vector2{-1.07, 0.5}, Vector2{1.07, -0.5}}) {
    ArenaWorld world = kick_off(3);
    world.ball = corner;
    const Game game = play(3, 30.0, world);
    std::printf("from (%.2f, %.2f): moved after %.1f s, %d goals, first after %.1f s\n", corner.x, corner.y,
                game.moved_s, game.goals, game.first_goal_s);
    EXPECT_EQ(game.own_goals, 0) << corner.x << " " << corner.y;
    scored += game.goals > 0 ? 1 : 0;
    moved += game.moved_s >= 0.0 && game.moved_s < 10.0 ? 1 : 0;
  }
  // A referee gives a free ball after 10 s. From one of the own corners there is no goal in 30 s.
  EXPECT_EQ(moved, 7);
  EXPECT_GE(scored, 6);
}

TEST(Game, TheGoalkeeperStopsShots) {
  // Shots at the goal from 0.7 m that the goalkeeper can reach. Without the goalkeeper, all of them are goals.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int stopped = 0, open = 0;
  constexpr int kShots = 60;
  for (int shot = 0; shot < kShots; ++shot) {
    const Vector2 from{-0.3, 0.5 * any(random)}, aim{-1.12, 0.15 * any(random)};
    for (const bool keeper : {true, false}) {
      ArenaWorld world;
      ArenaWorld::Robot robot;
      robot.id = 1;
      robot.position = {-1.03, 0.0};
      robot.heading = 1.57;
      if (keeper) world.robots.push_back(robot);
      world.ball = from;
      world.ball_velocity = (0.9 / distance(from, aim)) * (aim - from);
      Controller controller;
      ASSERT_TRUE(controller.configure({}, world.field).ok());
      Commands commands;
      while (world.time_s < 1.6) {
        controller.decide(world.tracks(), false, commands);
        world.obey(commands);
        world.advance(kFrame);
      }
      if (world.own_goals == 0) ++(keeper ? stopped : open);
    }
  }
  std::printf("keeper stopped %d of %d shots\n", stopped, kShots);
  EXPECT_GE(stopped, kShots * 8 / 10);
  EXPECT_LE(open, kShots / 10);
}

}  // namespace
}  // namespace touchline
