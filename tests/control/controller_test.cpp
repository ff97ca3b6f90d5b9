#include "core/control/controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/control/motion/drive_limits.h"
#include "core/control/turned_field.h"
#include "tests/control/arena_world.h"

namespace touchline {
namespace {

// Three robots and a ball, so that the controller has a task for each.
class ControllerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    world_.place_three_robots();
    ASSERT_TRUE(controller_.configure({}, world_.field).ok());
  }
  void run(int frames) {
    for (int k = 0; k < frames; ++k) {
      decide(world_.tracks());
      world_.obey(commands_);
      world_.advance(0.016);
    }
  }
  const Commands& decide(const Tracks& tracks, bool halted = false) {
    controller_.decide(tracks, halted, commands_);
    return commands_;
  }
  // Follows the commands with the lag that the controller believes, and returns the largest change of a wheel's speed.
  double largest_change(double period_s) {
    const DriveParameters drive;
    double largest = 0.0;
    for (std::size_t i = 0; i < commands_.robots.size(); ++i) {
      const Twist after = wheels_after(wheels_[i], commands_.robots[i].twist, period_s, drive);
      const WheelSpeeds from = wheels_of(wheels_[i], drive.wheel_base_m), to = wheels_of(after, drive.wheel_base_m);
      largest = std::max({largest, std::abs(static_cast<double>(to.left_mps - from.left_mps)),
                          std::abs(static_cast<double>(to.right_mps - from.right_mps))});
      wheels_[i] = after;
    }
    return largest;
  }
  [[nodiscard]] double speed(std::size_t i) const {
    const Twist& t = commands_.robots[i].twist;
    return std::abs(static_cast<double>(t.v_mps)) + 0.035 * std::abs(static_cast<double>(t.w_radps));
  }

  ArenaWorld world_;
  Controller controller_;
  Commands commands_;
  std::array<Twist, kMaxRobotsPerTeam> wheels_{};
};

TEST_F(ControllerTest, LimitsCanChangeDuringAGame) {
  for (int k = 0; k < 60; ++k) {
    run(1);
    largest_change(0.016);
  }
  const RobotId attacker = controller_.play().attacker();
  ControlParameters slow;
  slow.drive.max_speed_mps = 0.2;
  ASSERT_TRUE(controller_.set_parameters(slow).ok());
  EXPECT_EQ(controller_.play().attacker(), attacker);
  decide(world_.tracks());
  // The wheels' predicted speeds are also kept, so that no robot starts from rest or jumps.
  EXPECT_LE(largest_change(0.016), slow.drive.max_wheel_acceleration_mps2 * 0.016 + 1e-5);
  run(60);
  for (const RobotCommand& command : commands_.robots) EXPECT_LE(std::abs(command.twist.v_mps), 0.2f + 1e-6f);
  slow.drive.wheel_base_m = 0.0;
  EXPECT_EQ(controller_.set_parameters(slow).code(), ErrorCode::kOutOfRange);
}

TEST_F(ControllerTest, ListsOwnRobotsWithAnIdWithConsistentTwistAndWheels) {
  Tracks tracks = world_.tracks();
  RobotTrack other = tracks.robots[0];
  other.team = Team::kOpponent;
  tracks.robots.push_back(other);
  other.team = Team::kOwn;
  other.id = kUnknownId;
  tracks.robots.push_back(other);
  decide(tracks);
  EXPECT_FALSE(commands_.stop);
  ASSERT_EQ(commands_.robots.size(), 3u);
  run(20);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(commands_.robots[i].id, static_cast<RobotId>(2 * i + 1));
    const Twist back = twist_of(commands_.robots[i].wheels, DriveParameters{}.wheel_base_m);
    EXPECT_NEAR(back.v_mps, commands_.robots[i].twist.v_mps, 1e-6);
    EXPECT_NEAR(back.w_radps, commands_.robots[i].twist.w_radps, 1e-4);
  }
  EXPECT_GT(speed(1) + speed(2), 0.2) << "the robots must move";
}

TEST_F(ControllerTest, StopsRobotsWithoutARecentTrack) {
  run(20);
  Tracks tracks = world_.tracks();
  tracks.robots[0].state = TrackState::kNew;
  tracks.robots[1].state = TrackState::kCoasting;
  tracks.robots[1].last_seen = tracks.capture_time - from_seconds(0.16);
  tracks.robots[2].state = TrackState::kCoasting;
  tracks.robots[2].last_seen = tracks.capture_time - from_seconds(0.14);
  decide(tracks);
  ASSERT_EQ(commands_.robots.size(), 3u);
  EXPECT_EQ(speed(0), 0.0);
  EXPECT_EQ(speed(1), 0.0);
  EXPECT_GT(speed(2), 0.0) << "a short gap does not stop it";
}

TEST_F(ControllerTest, DoesNotListLostRobots) {
  run(20);
  Tracks tracks = world_.tracks(), rest = tracks;
  rest.robots.clear();
  rest.robots.push_back(tracks.robots[0]);
  rest.robots.push_back(tracks.robots[2]);
  decide(rest);
  ASSERT_EQ(commands_.robots.size(), 2u);
  EXPECT_EQ(commands_.robots[0].id, 1);
  EXPECT_EQ(commands_.robots[1].id, 5);
}

TEST_F(ControllerTest, StartsFromRestAfterAHalt) {
  run(40);
  EXPECT_GT(speed(1) + speed(2), 0.3);
  decide(world_.tracks(), true);
  EXPECT_TRUE(commands_.stop);
  ASSERT_EQ(commands_.robots.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(speed(i), 0.0);
  world_.advance(0.016);
  decide(world_.tracks());
  EXPECT_FALSE(commands_.stop);
  // The robots coasted to about a fifth of their speed: after that, the limit holds for the wheels, not for the
  // command.
  const DriveParameters drive;
  const double change = drive.max_wheel_acceleration_mps2 * 0.016 / wheel_response(0.016, drive);
  const double rest = drive.max_wheel_speed_mps * (1.0 - wheel_response(0.016, drive));
  for (const RobotCommand& robot : commands_.robots) {
    EXPECT_LE(std::abs(static_cast<double>(robot.wheels.left_mps)), change + rest);
    EXPECT_LE(std::abs(static_cast<double>(robot.wheels.right_mps)), change + rest);
  }
}

TEST_F(ControllerTest, KeepsEveryLimitInEveryFrame) {
  const DriveParameters drive;
  double fastest = 0.0, largest = 0.0;
  for (int k = 0; k < 1500; ++k) {
    run(1);
    for (const RobotCommand& now : commands_.robots) {
      ASSERT_LE(std::abs(static_cast<double>(now.twist.v_mps)), drive.max_speed_mps + 1e-5);
      ASSERT_LE(std::abs(static_cast<double>(now.twist.w_radps)), drive.max_turn_radps + 1e-4);
      fastest = std::max(fastest, static_cast<double>(now.wheels.left_mps));
    }
    const double change = largest_change(0.016);
    ASSERT_LE(change, drive.max_wheel_acceleration_mps2 * 0.016 + 1e-5) << k;
    largest = std::max(largest, change);
  }
  EXPECT_GT(largest, 0.9 * drive.max_wheel_acceleration_mps2 * 0.016) << "the drive is used";
  EXPECT_GT(fastest, 0.6);
}

TEST_F(ControllerTest, TellsTargetsInTheVenuesCoordinates) {
  PlayDecisions told, of_turned;
  decide(world_.tracks());
  controller_.explain(told);
  ASSERT_EQ(told.size(), 3u);
  // The same scene on the turned field.
  Controller other;
  ASSERT_TRUE(other.configure({}, world_.field).ok());
  other.set_turned(true);
  Tracks tracks;
  turn(world_.tracks(), tracks);
  Commands commands;
  other.decide(tracks, false, commands);
  other.explain(of_turned);
  ASSERT_EQ(of_turned.size(), 3u);
  int directions = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(of_turned[i].id, told[i].id);
    EXPECT_EQ(of_turned[i].skill_line, told[i].skill_line);
    ASSERT_EQ(of_turned[i].target.has_value(), told[i].target.has_value());
    if (!told[i].target) continue;
    EXPECT_NEAR(of_turned[i].target->x_m, -told[i].target->x_m, 1e-4);
    EXPECT_NEAR(of_turned[i].target->y_m, -told[i].target->y_m, 1e-4);
    if (!told[i].direction_rad) continue;
    ++directions;
    EXPECT_NEAR(std::abs(std::remainder(*of_turned[i].direction_rad - *told[i].direction_rad, 6.2831853f)), 3.1415927f,
                1e-3);
  }
  EXPECT_GT(directions, 0);
  decide(world_.tracks(), true);
  controller_.explain(told);
  EXPECT_TRUE(told.empty()) << "halted";
}

TEST_F(ControllerTest, WithoutABallOnlyTheGoalkeeperMoves) {
  for (int k = 0; k < 400; ++k) {
    Tracks tracks = world_.tracks();
    tracks.ball = BallTrack();
    decide(tracks);
    world_.obey(commands_);
    world_.advance(0.016);
    EXPECT_EQ(speed(1), 0.0);
    EXPECT_EQ(speed(2), 0.0);
  }
  ASSERT_EQ(controller_.play().goalkeeper(), 1);
  EXPECT_NEAR(world_.robots[0].position.x, -1.1 + PlayParameters{}.keeper_line_m, 0.04);
  EXPECT_NEAR(world_.robots[0].position.y, 0.0, 0.03);
}

TEST_F(ControllerTest, StandsStillWhenTheGameIsDisabled) {
  ControlParameters parameters;
  parameters.play.enabled = false;
  ASSERT_TRUE(controller_.configure(parameters, world_.field).ok());
  run(30);
  EXPECT_FALSE(commands_.stop);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(speed(i), 0.0);
}

TEST_F(ControllerTest, AcceptsMoreRobotsThanATeamHas) {
  Tracks tracks = world_.tracks();
  while (!tracks.robots.full()) {
    RobotTrack robot = tracks.robots[0];
    robot.id = static_cast<RobotId>(20 + tracks.robots.size());
    tracks.robots.push_back(robot);
  }
  decide(tracks);
  EXPECT_EQ(commands_.robots.size(), kMaxRobotsPerTeam);
  EXPECT_EQ(commands_.robots.overflow(), 0u) << "a packet must still be sent";
}

TEST_F(ControllerTest, RejectsImpossibleDrives) {
  ControlParameters parameters;
  parameters.drive.wheel_base_m = 0.0;
  EXPECT_EQ(controller_.configure(parameters, world_.field).code(), ErrorCode::kOutOfRange);
  parameters = {};
  parameters.drive.max_speed_mps = std::nan("");
  EXPECT_EQ(controller_.configure(parameters, world_.field).code(), ErrorCode::kOutOfRange);
  FieldParameters no_field;
  no_field.length_m = 0.0f;
  EXPECT_EQ(controller_.configure({}, no_field).code(), ErrorCode::kOutOfRange);
}

}  // namespace
}  // namespace touchline
