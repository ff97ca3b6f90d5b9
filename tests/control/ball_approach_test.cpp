#include "core/control/ball_approach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/control/motion/drive_limits.h"
#include "core/geometry/angle.h"
#include "tests/control/small_world.h"

namespace touchline {
namespace {

constexpr PlayParameters kApproachParameters;
constexpr FieldParameters kApproachField;

TEST(PlanPush, AimsAtTheGoalFromMidField) {
  const PushPlan plan = plan_push({0.0, 0.5}, kApproachField, kApproachParameters);
  EXPECT_FALSE(plan.in_corner);
  EXPECT_NEAR(norm(plan.direction), 1.0, 1e-12);
  EXPECT_GT(plan.direction.x, 0.9);
  EXPECT_LT(plan.direction.y, -0.2);
  EXPECT_NEAR(distance(plan.behind, plan.ball), kApproachParameters.behind_ball_m, 1e-12);
  EXPECT_GT(plan.behind.y, 0.5) << "behind the ball as seen from the goal";
}

TEST(PlanPush, GoesAlongWallsAndStaysInsideTheField) {
  EXPECT_EQ(plan_push({0.0, 0.88}, kApproachField, kApproachParameters).direction.x, 1.0);
  EXPECT_EQ(plan_push({-1.08, 0.5}, kApproachField, kApproachParameters).direction.y, 1.0) << "away from the own goal";
  EXPECT_EQ(plan_push({-1.08, -0.5}, kApproachField, kApproachParameters).direction.y, -1.0);
  EXPECT_LT(plan_push({1.08, 0.5}, kApproachField, kApproachParameters).direction.y, -0.9) << "into the goal";
  EXPECT_GT(plan_push({1.08, 0.5}, kApproachField, kApproachParameters).direction.x, 0.2) << "and not past it";
  EXPECT_GT(plan_push({1.08, 0.1}, kApproachField, kApproachParameters).direction.x, 0.8)
      << "in front of the goal: straight into it";
  for (const double x : {-1.08, 1.08}) {
    for (const double y : {-0.88, 0.88})
      EXPECT_TRUE(plan_push({x, y}, kApproachField, kApproachParameters).in_corner) << x << " " << y;
  }
  for (double x = -1.1; x <= 1.1; x += 0.01) {
    for (double y = -0.9; y <= 0.9; y += 0.01) {
      const PushPlan plan = plan_push({x, y}, kApproachField, kApproachParameters);
      ASSERT_NEAR(norm(plan.direction), 1.0, 1e-9);
      ASSERT_LE(std::abs(plan.behind.x), 1.1 - kApproachParameters.robot_radius_m);
      ASSERT_LE(std::abs(plan.behind.y), 0.9 - kApproachParameters.robot_radius_m);
    }
  }
}

// One robot, one ball at rest: the ball ends in the goal and is hardly pushed in the wrong direction.
TEST(GoToBall, BringsTheBallToTheGoalFromAnywhere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const DriveParameters drive;
  const MotionParameters gains;
  int scored = 0, back = 0;
  constexpr int kRuns = 150;
  for (int run = 0; run < kRuns; ++run) {
    SmallWorld world;
    SmallWorld::Robot robot;
    robot.id = 0;
    robot.position = {any(random), 0.8 * any(random)};
    robot.heading = 3.1 * any(random);
    world.robots.push_back(robot);
    do {
      world.ball = {0.7 * any(random), 0.6 * any(random)};
    } while (distance(world.ball, robot.position) < 0.15);
    const double begin = world.ball.x;
    double least = begin;
    Commands commands;
    commands.stop = false;
    commands.robots.push_back({});
    Twist last;
    while (world.time_s < 20.0 && world.goals == 0) {
      const RobotTrack track = world.tracks().robots[0];
      const Approach approach =
          go_to_ball(track.pose, track.twist, plan_push(world.ball, kApproachField, kApproachParameters),
                     kApproachParameters, drive, gains);
      last = within_acceleration_limit(within_speed_limits(approach.twist, drive), last, 0.016, drive);
      commands.robots[0] = {0, last, {}};
      world.obey(commands);
      world.advance(0.016);
      if (world.goals == 0) least = std::min(least, world.ball.x);
    }
    scored += world.goals;
    back += least < begin - 0.1 ? 1 : 0;
  }
  std::printf("%d of %d scored, %d pushed the ball back by more than 0.1 m\n", scored, kRuns, back);
  EXPECT_GE(scored, kRuns * 9 / 10);
  EXPECT_LE(back, kRuns / 15);
}

TEST(GoToBall, SpinsABallOutOfACornerInTheRightDirection) {
  const DriveParameters drive;
  for (const double x : {-1.07, 1.07}) {
    for (const double y : {-0.87, 0.87}) {
      const PushPlan plan = plan_push({x, y}, kApproachField, kApproachParameters);
      const Pose robot{to_field_point(0.94 * plan.ball), 0.3f};
      const Approach approach = go_to_ball(robot, {}, plan, kApproachParameters, drive, {});
      ASSERT_EQ(approach.phase, ApproachPhase::kSpin);
      // Velocity of the robot's side at the ball: along the wall, to the goal in a far corner and up the field in an
      // own one.
      const Vector2 rim = static_cast<double>(approach.twist.w_radps) * perpendicular(plan.ball - position(robot));
      EXPECT_GT(x > 0.0 ? -rim.y * y : rim.x, 0.0) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace touchline
