#include "core/control/strike.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/control/motion/drive_limits.h"
#include "tests/control/arena_world.h"

namespace touchline {
namespace {

Scene scene_with(Vector2 ball, Vector2 velocity = {}) {
  Scene scene;
  scene.pitch = Pitch(FieldParameters{}, PlayParameters{});
  scene.ball_known = true;
  scene.ball = ball;
  scene.ball_velocity = velocity;
  scene.path = BallPath({ball, velocity}, scene.pitch);
  return scene;
}

TEST(BallPath, ReflectsAtWallsAndRollsIntoGoals) {
  const Pitch pitch;
  const BallPath wall({{0.0, 0.7}, {0.0, 1.0}}, pitch);
  EXPECT_LT(wall.at(0.6).velocity.y, -0.2);
  EXPECT_LT(wall.at(0.6).position.y, 0.8);
  for (double t = 0.0; t < 2.0; t += 0.01) EXPECT_LE(wall.at(t).position.y, 0.9 - pitch.ball_m + 1e-9) << t;
  const BallPath goal({{0.8, 0.0}, {1.5, 0.0}}, pitch);
  EXPECT_GT(goal.at(0.5).position.x, 1.1);
}

TEST(BallPath, RollsAsFarAsItsDecelerationLets) {
  Pitch pitch;
  pitch.rolling.damping_per_s = 0.0;
  pitch.rolling.deceleration_mps2 = 0.5;
  const BallPath constant({{-0.5, 0.0}, {0.8, 0.0}}, pitch);  // stops after 1.6 s and 0.64 m
  EXPECT_NEAR(constant.at(1.0).position.x, -0.5 + 0.8 - 0.25, 1e-9);
  EXPECT_NEAR(constant.at(1.0).velocity.x, 0.3, 1e-9);
  EXPECT_NEAR(constant.at(2.0).position.x, 0.14, 1e-9);
  EXPECT_EQ(constant.at(2.0).velocity.x, 0.0);
  pitch.rolling.deceleration_mps2 = 0.0;
  pitch.rolling.damping_per_s = 0.5;
  const BallPath damped({{-0.5, 0.0}, {0.8, 0.0}}, pitch);
  EXPECT_NEAR(damped.at(1.0).velocity.x, 0.8 * std::exp(-0.5), 1e-4);
  EXPECT_NEAR(damped.at(1.0).position.x, -0.5 + 0.8 * (1.0 - std::exp(-0.5)) / 0.5, 1e-4);
}

TEST(Struck, ConservesMomentum) {
  BallMotionParameters ball;
  ball.mass_ratio = 0.25;
  ball.robot_restitution = 0.5;
  const BallState after = struck({{}, {-0.4, 0.3}}, 0.0, 1.0, ball);
  // The robot of mass 1 keeps the momentum that the ball of mass 0.25 got; they separate at 0.5 of 1.4 m/s.
  EXPECT_NEAR(after.velocity.x, -0.4 + 1.4 * 1.5 / 1.25, 1e-12);
  EXPECT_NEAR(after.velocity.y, 0.3, 1e-12);
  EXPECT_NEAR(struck({{}, {2.0, 0.0}}, 0.0, 1.0, ball).velocity.x, 2.0, 1e-12) << "the ball is faster";
}

TEST(TimeToGoal, PrefersTheGoalAndFearsTheOwnOne) {
  Scene scene = scene_with({0.5, 0.0});
  const double shot = time_to_goal({{0.5, 0.0}, {1.5, 0.0}}, scene);
  EXPECT_GT(shot, 0.3);
  EXPECT_LT(shot, 0.6);
  EXPECT_GT(time_to_goal({{0.5, 0.0}, {1.0, 1.0}}, scene), shot + 0.5) << "beside the goal";
  EXPECT_GT(time_to_goal({{-0.5, 0.0}, {-1.5, 0.0}}, scene), 10.0);
  scene.opponents.push_back({{0.9, 0.0}, {}});
  EXPECT_GT(time_to_goal({{0.5, 0.0}, {1.5, 0.0}}, scene), shot + 0.5) << "stopped by an opponent";
}

TEST(StrikeOptions, AimAtTheFreePartOfTheGoal) {
  Scene scene = scene_with({0.6, 0.0});
  scene.opponents.push_back({{1.05, 0.08}, {}});
  StrikeOptions options;
  options.find(scene);
  const Player robot{1, {to_field_point({0.2, 0.0}), 0.0f}, {}};
  const Strike strike = options.best_for(robot, nullptr, scene);
  const double y = 0.5 * std::tan(strike.direction_rad);
  EXPECT_LT(y, -0.03);
  EXPECT_GT(y, -0.2);
  EXPECT_LT(strike.contact_s, 0.8);
}

TEST(StrikeOptions, MeetARollingBallAheadOfIt) {
  const Scene scene = scene_with({0.0, 0.5}, {0.0, -0.6});
  StrikeOptions options;
  options.find(scene);
  const Player robot{1, {to_field_point({-0.5, 0.0}), 0.0f}, {}};
  const Strike strike = options.best_for(robot, nullptr, scene);
  EXPECT_LT(strike.ball.y, 0.4);
  EXPECT_NEAR(strike.ball.y, scene.path.at(strike.contact_s).position.y, 0.1);
}

TEST(StrikeOptions, KeepTheContactPlaceInsideTheField) {
  for (double x = -1.07; x <= 1.07; x += 0.0535) {
    for (double y = -0.875; y <= 0.875; y += 0.04375) {
      const Scene scene = scene_with({x, y});
      StrikeOptions options;
      options.find(scene);
      const Player robot{1, {to_field_point({0.0, 0.0}), 0.3f}, {}};
      const Strike strike = options.best_for(robot, nullptr, scene);
      ASSERT_LE(std::abs(strike.goal.place.x), 1.1 - 0.037) << x << " " << y;
      ASSERT_LE(std::abs(strike.goal.place.y), 0.9 - 0.037) << x << " " << y;
    }
  }
}

// One robot, a ball at rest: it drives through the ball at speed, towards the goal, and seldom to the own one.
TEST(Drive, StrikesARestingBallFromAnywhere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const DriveParameters limits;
  int struck = 0, back = 0;
  double time = 0.0, speed = 0.0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    ArenaWorld world;
    ArenaWorld::Robot robot;
    robot.id = 0;
    robot.position = {any(random), 0.8 * any(random)};
    robot.heading = 3.1 * any(random);
    world.robots.push_back(robot);
    do {
      world.ball = {0.9 * any(random), 0.75 * any(random)};
    } while (distance(world.ball, robot.position) < 0.15);
    const Vector2 begin = world.ball;
    Twist last;
    double direction = 0.0;
    while (world.time_s < 4.0 && norm(world.ball_velocity) < 0.5) {
      const RobotTrack track = world.tracks().robots[0];
      const Player player{0, track.pose, track.twist};
      const Scene scene = scene_with(world.ball, world.ball_velocity);
      StrikeOptions options;
      options.find(scene);
      const Strike strike = options.best_for(player, world.time_s > 0.0 ? &direction : nullptr, scene);
      direction = strike.direction_rad;
      const Twist wanted = drive(player, strike.goal, {}, scene.pitch, kFrame, limits);
      last = within_acceleration_limit(within_speed_limits(wanted, limits), last, kFrame, limits);
      Commands commands;
      commands.stop = false;
      commands.robots.push_back({0, last, {}});
      world.obey(commands);
      world.advance(kFrame);
    }
    if (norm(world.ball_velocity) < 0.5) continue;
    ++struck;
    time += world.time_s;
    speed += norm(world.ball_velocity);
    const double off = std::abs(world.ball.y + (1.1 - world.ball.x) / world.ball_velocity.x * world.ball_velocity.y);
    back += world.ball_velocity.x < 0.0 && begin.x < 0.0 && off < 0.2 ? 1 : 0;
  }
  std::printf("%d of %d struck, after %.2f s, %.2f m/s, %d to the own goal\n", struck, kRuns, time / struck,
              speed / struck, back);
  EXPECT_GE(struck, kRuns * 97 / 100);
  EXPECT_LT(time / struck, 1.7);
  EXPECT_GT(time / struck, 0.6) << "the way takes time";
  EXPECT_GT(speed / struck, 0.8);
  EXPECT_LE(back, 2);
}

}  // namespace
}  // namespace touchline
