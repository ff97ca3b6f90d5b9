// From speeds to motors.
#include <gtest/gtest.h>

#include "tools/robot/touchline_robot.h"

namespace touchline {
namespace {

using touchline_robot::limited;
using touchline_robot::pwm_from_speed;
using touchline_robot::wheels_from_twist;

TEST(RobotMotors, PwmStartsWhereTheWheelTurns) {
  EXPECT_EQ(pwm_from_speed(0, 1500, 30), 0);
  EXPECT_EQ(pwm_from_speed(1, 1500, 30), 30);
  EXPECT_EQ(pwm_from_speed(-1, 1500, 30), -30);
  EXPECT_EQ(pwm_from_speed(750, 1500, 30), 142);
  EXPECT_EQ(pwm_from_speed(-750, 1500, 30), -142);
  EXPECT_EQ(pwm_from_speed(1500, 1500, 30), 255);
  EXPECT_EQ(pwm_from_speed(32767, 1500, 30), 255);
  EXPECT_EQ(pwm_from_speed(-32768, 1500, 0), -255);
  EXPECT_EQ(pwm_from_speed(32767, 1, 0), 255);
  for (int v = -2000; v < 2000; ++v) {
    const auto speed = static_cast<std::int16_t>(v);
    EXPECT_LE(pwm_from_speed(speed, 1500, 30), pwm_from_speed(static_cast<std::int16_t>(v + 1), 1500, 30));
  }
}

TEST(RobotMotors, WheelSpeedsOfATwist) {
  EXPECT_EQ(wheels_from_twist(500, 0, 75).left_mmps, 500);
  EXPECT_EQ(wheels_from_twist(500, 0, 75).right_mmps, 500);
  // Counter-clockwise: the right wheel is faster. 4 rad/s times half of 75 mm.
  EXPECT_EQ(wheels_from_twist(500, 4000, 75).left_mmps, 350);
  EXPECT_EQ(wheels_from_twist(500, 4000, 75).right_mmps, 650);
  EXPECT_EQ(wheels_from_twist(32767, 2000000000, 60000).right_mmps, 32767) << "saturated";
  EXPECT_EQ(wheels_from_twist(-32768, 2000000000, 60000).left_mmps, -32767);
}

TEST(RobotMotors, ALimitedRobotStaysOnItsCurve) {
  EXPECT_EQ(limited({500, -250}, 500).left_mmps, 500);
  EXPECT_EQ(limited({500, -250}, 500).right_mmps, -250);
  EXPECT_EQ(limited({1000, -500}, 500).left_mmps, 500);
  EXPECT_EQ(limited({1000, -500}, 500).right_mmps, -250);
  EXPECT_EQ(limited({16384, -32768}, 32767).right_mmps, -32767);
  EXPECT_EQ(limited({16384, -32768}, 1000).left_mmps, 500);
}

TEST(RobotMotors, TurnsOfTheWheel) {
  EXPECT_NEAR(touchline_robot::turns_per_second(1000, 40.0f), 7.9577f, 1e-3f);
  EXPECT_NEAR(touchline_robot::turns_per_second(-500, 40.0f), -3.9789f, 1e-3f);
}

}  // namespace
}  // namespace touchline
