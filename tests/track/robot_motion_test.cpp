// Two models of the motion of a robot: it follows its commands, or it is in contact.
#include "core/track/robot_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

constexpr double kFrame = 1.0 / 60.0;
constexpr double kNoise_m = 0.0003, kNoise_rad = 0.004;

// Drives `robot` with `command` for some frames; `blocked`: it stands although its wheels turn.
void drive(RobotMotion& motion, SimulatedRobot& robot, const Twist& command, int frames, bool blocked) {
  const RobotFilterParameters parameters;
  for (int k = 0; k < frames; ++k) {
    if (!blocked) robot.advance(command, std::round(kFrame / 0.0005) * 0.0005);
    motion.predict(kFrame, {true, command}, parameters);
    motion.update(robot.sighted(kNoise_m, kNoise_rad), sighting_noise(kNoise_m, kNoise_rad), parameters);
  }
}

// Where the motion predicts the robot after three frames, along x from its present place.
double ahead(RobotMotion motion, const Twist& command) {
  const double now = static_cast<double>(motion.pose().position.x_m);
  for (int k = 0; k < 3; ++k) motion.predict_state(kFrame, {true, command}, {});
  return static_cast<double>(motion.pose().position.x_m) - now;
}

TEST(RobotMotion, LearnsThatAWallBlocksTheRobot) {
  SimulatedRobot robot({}, 3);
  RobotMotion motion;
  motion.start(robot.pose(), {0.0, 0.0, 0.1, 1.0}, kNoise_m, kNoise_rad);
  const Twist forward{0.5f, 0.0f};
  drive(motion, robot, forward, 60, false);
  EXPECT_LT(motion.contact(), 0.3);
  EXPECT_NEAR(ahead(motion, forward), 0.025, 0.002) << "three frames at 0.5 m/s";

  robot.v = 0.0;
  drive(motion, robot, forward, 30, true);
  EXPECT_GT(motion.contact(), 0.7);
  EXPECT_LT(ahead(motion, forward), 0.006) << "the commands alone would give 12 mm";

  const Twist back{-0.5f, 0.0f};
  drive(motion, robot, back, 30, false);
  EXPECT_LT(motion.contact(), 0.3);
  EXPECT_NEAR(ahead(motion, back), -0.025, 0.003);
}

// Pushed to the side at constant speed.
TEST(RobotMotion, FollowsARobotThatIsPushedSideways) {
  SimulatedRobot robot({}, 4);
  RobotMotion motion;
  motion.start(robot.pose(), {0.0, 0.0, 0.1, 1.0}, kNoise_m, kNoise_rad);
  drive(motion, robot, {}, 30, false);
  const RobotFilterParameters parameters;
  for (int k = 0; k < 30; ++k) {
    robot.y += 0.2 * kFrame;
    motion.predict(kFrame, {true, {}}, parameters);
    motion.update(robot.sighted(kNoise_m, kNoise_rad), sighting_noise(kNoise_m, kNoise_rad), parameters);
  }
  EXPECT_GT(motion.contact(), 0.7);
  EXPECT_NEAR(motion.both().state()[5], 0.2, 0.06);
  EXPECT_NEAR(static_cast<double>(motion.pose().position.y_m), robot.y, 0.001);
}

}  // namespace
}  // namespace touchline
