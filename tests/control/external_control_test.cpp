// Robots that another program drives: limits, age of the commands, and the built-in play beside them.
#include "core/control/external_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/control/controller.h"
#include "core/control/motion/drive_limits.h"
#include "core/control/turned_field.h"
#include "core/geometry/angle.h"
#include "tests/control/arena_world.h"

namespace touchline {
namespace {

using Kind = ExternalCommand::Kind;

ExternalCommand twist_command(RobotId id, float v_mps, float w_radps) {
  ExternalCommand command;
  command.id = id;
  command.twist = {v_mps, w_radps};
  return command;
}

ExternalCommand pose_command(RobotId id, Vector2 place) {
  ExternalCommand command;
  command.id = id;
  command.kind = Kind::kPose;
  command.target.position = to_field_point(place);
  return command;
}

// Robots 1, 3 and 5 and a ball.
class ExternalControlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    world_.place_three_robots();
    configure({});
  }
  void configure(const ControlParameters& parameters) {
    ASSERT_TRUE(controller_.configure(parameters, world_.field).ok());
  }

  // Replaces the former command of this robot by one that arrives now.
  void give(ExternalCommand command) {
    command.received = now();
    for (ExternalCommand& former : table_) {
      if (former.id == command.id) {
        former = command;
        return;
      }
    }
    table_.push_back(command);
  }
  [[nodiscard]] Instant now() const { return at(world_.time_s); }
  const Commands& decide(bool halted = false) {
    controller_.set_external(table_, now());
    controller_.decide(world_.tracks(), halted, commands_);
    return commands_;
  }
  void frame() {
    decide();
    world_.obey(commands_);
    world_.advance(kFrame);
  }
  [[nodiscard]] const RobotCommand& of(RobotId id) const {
    static const RobotCommand kNone;
    for (const RobotCommand& command : commands_.robots) {
      if (command.id == id) return command;
    }
    ADD_FAILURE() << "no command for robot " << static_cast<int>(id);
    return kNone;
  }
  [[nodiscard]] bool stands(RobotId id) const { return of(id).twist.v_mps == 0.0f && of(id).twist.w_radps == 0.0f; }
  ArenaWorld::Robot& robot(RobotId id) { return world_.robots[static_cast<std::size_t>(id / 2)]; }

  ArenaWorld world_;
  Controller controller_;
  Commands commands_;
  ExternalCommands table_;
};

TEST_F(ExternalControlTest, TwistAndWheelsAreReachedWithinTheAccelerationLimit) {
  for (int k = 0; k < 40; ++k) {
    give(twist_command(1, 0.5f, -2.0f));
    ExternalCommand wheels;
    wheels.id = 3;
    wheels.kind = Kind::kWheels;
    wheels.wheels = {0.3f, -0.1f};
    give(wheels);
    frame();
    if (k > 0) continue;
    EXPECT_LT(of(1).twist.v_mps, 0.1f) << "starts from rest";
  }
  EXPECT_EQ(of(1).source, CommandSource::kExternal);
  EXPECT_NEAR(of(1).twist.v_mps, 0.5f, 1e-5f);
  EXPECT_NEAR(of(1).twist.w_radps, -2.0f, 1e-4f);
  EXPECT_NEAR(of(3).wheels.left_mps, 0.3f, 1e-5f);
  EXPECT_NEAR(of(3).wheels.right_mps, -0.1f, 1e-5f);
  EXPECT_EQ(of(5).source, CommandSource::kPlay);
}

TEST_F(ExternalControlTest, NoCommandExceedsTheLimits) {
  const DriveParameters drive;
  std::mt19937 random(1);
  const auto value = [&]() -> float {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr std::array kSpecial{0.0f,
                                  -0.0f,
                                  1e-40f,
                                  1e30f,
                                  std::numeric_limits<float>::max(),
                                  -kInfinity,
                                  kInfinity,
                                  std::numeric_limits<float>::quiet_NaN()};
    const auto choice = random() % 16;
    if (choice < kSpecial.size()) return kSpecial[choice];
    return std::uniform_real_distribution<float>(-3.0f, 3.0f)(random) * (choice == 15 ? 100.0f : 1.0f);
  };
  decide();
  std::array<Twist, 3> wheels{};  // as the controller predicts them
  double fastest = 0.0;
  std::size_t driven = 0;
  for (int k = 0; k < 20000; ++k) {
    for (const RobotId id : std::array<RobotId, 3>{1, 3, 5}) {
      if (random() % 4 != 0) continue;
      ExternalCommand command;
      command.id = id;
      command.kind = static_cast<Kind>(random() % 4);
      command.twist = {value(), value()};
      command.wheels = {value(), value()};
      command.target = {{value(), value()}, value()};
      command.has_heading = random() % 2 == 0;
      give(command);
      if (random() % 8 == 0) table_.back().received -= from_seconds(0.4 * static_cast<double>(random() % 100) / 100.0);
    }
    frame();
    ASSERT_EQ(commands_.robots.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const RobotCommand& now = commands_.robots[i];
      ASSERT_LE(std::abs(static_cast<double>(now.twist.v_mps)), drive.max_speed_mps + 1e-5);
      ASSERT_LE(std::abs(static_cast<double>(now.twist.w_radps)), drive.max_turn_radps + 1e-4);
      for (const auto wheel : {&WheelSpeeds::left_mps, &WheelSpeeds::right_mps}) {
        const auto speed = static_cast<double>(now.wheels.*wheel);
        ASSERT_LE(std::abs(speed), drive.max_wheel_speed_mps + 1e-5);
        fastest = std::max(fastest, std::abs(speed));
      }
      const Twist after = wheels_after(wheels[i], now.twist, kFrame, drive);
      const WheelSpeeds from = wheels_of(wheels[i], drive.wheel_base_m), to = wheels_of(after, drive.wheel_base_m);
      wheels[i] = after;
      if (now.source != CommandSource::kExpired) {  // which stops at once
        const double limit = drive.max_wheel_acceleration_mps2 * kFrame + 1e-5;
        ASSERT_LE(std::abs(static_cast<double>(to.left_mps - from.left_mps)), limit) << k;
        ASSERT_LE(std::abs(static_cast<double>(to.right_mps - from.right_mps)), limit) << k;
      }
      driven += now.source == CommandSource::kExternal ? 1 : 0;
    }
  }
  EXPECT_GT(fastest, 1.0);
  EXPECT_GT(driven, 20000U);
}

TEST_F(ExternalControlTest, AgeLimitIsExactToOneFrame) {
  for (const double max_age_s : {0.02, 0.2, 1.0}) {
    ControlParameters parameters;
    parameters.external.max_age_s = max_age_s;
    configure(parameters);
    for (int k = 0; k < 20; ++k) {
      give(twist_command(3, 0.3f, 4.0f));
      frame();
    }
    const double last_s = world_.time_s - kFrame;
    while (world_.time_s - last_s <= max_age_s) {
      decide();
      EXPECT_EQ(of(3).source, CommandSource::kExternal) << world_.time_s - last_s;
      EXPECT_FALSE(stands(3));
      frame();
    }
    for (int k = 0; k < 100; ++k) {
      frame();
      EXPECT_EQ(of(3).source, CommandSource::kExpired);
      EXPECT_TRUE(stands(3));
    }
  }
}

TEST_F(ExternalControlTest, WhenAProgramEndsItsRobotsStandAndTheOthersPlayOn) {
  for (int k = 0; k < 60; ++k) {
    give(twist_command(5, 0.0f, 3.0f));
    frame();
  }
  const int frames = static_cast<int>(ExternalParameters{}.max_age_s / kFrame) + 1;
  for (int k = 0; k < frames; ++k) frame();
  double played_m = 0.0;
  for (int k = 0; k < 600; ++k) {
    const Vector2 before = robot(3).position;
    frame();
    ASSERT_TRUE(stands(5));
    played_m += distance(robot(3).position, before);
  }
  EXPECT_GT(played_m, 0.5);
  EXPECT_NE(controller_.play().attacker(), 5);
  EXPECT_NE(controller_.play().goalkeeper(), 5);
}

TEST_F(ExternalControlTest, OnlyAReleaseReturnsARobotToThePlay) {
  give(twist_command(3, 0.0f, 0.0f));
  for (int k = 0; k < 200; ++k) frame();
  EXPECT_TRUE(stands(3));
  controller_.reset();  // the camera was reopened
  for (int k = 0; k < 200; ++k) frame();
  EXPECT_EQ(of(3).source, CommandSource::kExpired);
  EXPECT_TRUE(stands(3));
  ExternalCommand release;
  release.id = 3;
  release.kind = Kind::kRelease;
  give(release);
  double turned = 0.0;
  for (int k = 0; k < 200; ++k) {
    frame();
    EXPECT_EQ(of(3).source, CommandSource::kPlay);
    turned += std::abs(static_cast<double>(of(3).wheels.left_mps));
  }
  EXPECT_GT(turned, 1.0);
}

TEST_F(ExternalControlTest, RobotsOfAnotherProgramAreDrivenWithoutThePlayToo) {
  ControlParameters parameters;
  parameters.play.enabled = false;
  configure(parameters);
  for (int k = 0; k < 10; ++k) {
    give(twist_command(3, 0.2f, 0.0f));
    frame();
  }
  EXPECT_GT(of(3).twist.v_mps, 0.1f);
  EXPECT_TRUE(stands(1));
  EXPECT_TRUE(stands(5));
}

TEST_F(ExternalControlTest, AHaltAndALongGapInTheTrackStopThemAsWell) {
  for (int k = 0; k < 10; ++k) {
    give(twist_command(3, 0.2f, 0.0f));
    frame();
  }
  decide(true);
  EXPECT_TRUE(commands_.stop);
  EXPECT_TRUE(stands(3));
  world_.advance(kFrame);
  Tracks tracks = world_.tracks();
  tracks.robots[1].state = TrackState::kCoasting;
  tracks.robots[1].last_seen = tracks.capture_time - from_seconds(0.16);
  controller_.set_external(table_, now());
  controller_.decide(tracks, false, commands_);
  EXPECT_TRUE(stands(3));
}

TEST_F(ExternalControlTest, DrivesToAPoseAroundOtherRobots) {
  robot(3).position = {-0.5, 0.0};
  robot(1).position = {0.0, 0.02};  // on the straight way
  robot(5).position = {0.9, 0.7};
  robot(1).jammed = robot(5).jammed = true;
  world_.ball = {0.0, 0.8};
  ControlParameters parameters;
  parameters.play.enabled = false;
  configure(parameters);
  double nearest = 1.0;
  for (int k = 0; k < 300; ++k) {
    ExternalCommand command = pose_command(3, {0.5, 0.0});
    command.target.theta_rad = -2.0f;
    command.has_heading = true;
    give(command);
    frame();
    nearest = std::min(nearest, distance(robot(3).position, robot(1).position));
  }
  EXPECT_LT(distance(robot(3).position, {0.5, 0.0}), 0.015);
  EXPECT_NEAR(wrap_angle(robot(3).heading + 2.0), 0.0, 0.05) << "not turned by 180 degrees";
  EXPECT_GT(nearest, 0.085);
  for (int k = 0; k < 200; ++k) {
    give(pose_command(3, {0.5, 0.4}));
    frame();
  }
  EXPECT_LT(distance(robot(3).position, {0.5, 0.4}), 0.015) << "any heading";
}

TEST_F(ExternalControlTest, AReleasedTableChangesNoBitOfTheGame) {
  for (int i = 0; i < 10; ++i) {
    ExternalCommand release;
    release.id = static_cast<RobotId>(i);
    release.kind = Kind::kRelease;
    table_.push_back(release);
  }
  ArenaWorld other_world = world_;
  Controller other;
  ASSERT_TRUE(other.configure({}, world_.field).ok());
  Commands expected;
  for (int k = 0; k < 600; ++k) {
    other.decide(other_world.tracks(), false, expected);
    other_world.obey(expected);
    other_world.advance(kFrame);
    frame();
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(std::memcmp(&commands_.robots[i].wheels, &expected.robots[i].wheels, sizeof(WheelSpeeds)), 0) << k;
    }
  }
}

TEST_F(ExternalControlTest, OnTheOtherSideTheSameGameIsPlayedTurnedBy180Degrees) {
  // The ball is not exactly ahead of a robot, where rounding decides on which side the robot passes.
  world_.ball.y = 0.14;
  // Targets are in the venue's coordinates on both sides.
  give(pose_command(1, {0.4, -0.3}));
  Controller other;
  ASSERT_TRUE(other.configure({}, world_.field).ok());
  other.set_turned(true);
  double moved = 0.0;
  for (int k = 0; k < 200; ++k) {
    give(pose_command(1, {0.4, -0.3}));
    Tracks tracks;
    turn(world_.tracks(), tracks);
    ExternalCommands table = table_;
    table[0].target = turned(table_[0].target);
    Commands turned_commands;
    other.set_external(table, now());
    other.decide(tracks, false, turned_commands);
    frame();
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(turned_commands.robots[i].twist.v_mps, commands_.robots[i].twist.v_mps, 2e-3) << k;
      EXPECT_NEAR(turned_commands.robots[i].twist.w_radps, commands_.robots[i].twist.w_radps, 2e-2) << k;
      moved += std::abs(static_cast<double>(commands_.robots[i].twist.v_mps));
    }
  }
  EXPECT_GT(moved, 10.0);
}

}  // namespace
}  // namespace touchline
