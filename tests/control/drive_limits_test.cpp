#include "core/control/motion/drive_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace touchline {
namespace {

constexpr DriveParameters kDrive;

float larger_wheel(const Twist& twist) {
  const WheelSpeeds wheels = wheels_of(twist, kDrive.wheel_base_m);
  return std::max(std::abs(wheels.left_mps), std::abs(wheels.right_mps));
}

TEST(DriveLimits, WheelsAndTwistAreInverseFunctions) {
  const WheelSpeeds left_turn = wheels_of({0.5f, 2.0f}, 0.07);
  EXPECT_FLOAT_EQ(left_turn.left_mps, 0.43f);
  EXPECT_FLOAT_EQ(left_turn.right_mps, 0.57f);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> any(-3.0f, 3.0f);
  for (int i = 0; i < 1000; ++i) {
    const Twist twist{any(random), 5.0f * any(random)};
    const Twist back = twist_of(wheels_of(twist, 0.07), 0.07);
    EXPECT_NEAR(back.v_mps, twist.v_mps, 1e-6);
    EXPECT_NEAR(back.w_radps, twist.w_radps, 1e-5);
  }
}

TEST(DriveLimits, ALimitedRobotStaysOnItsCurve) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> any(-5.0f, 5.0f);
  int limited = 0;
  for (int i = 0; i < 10000; ++i) {
    const Twist wanted{any(random), 10.0f * any(random)};
    const Twist got = within_speed_limits(wanted, kDrive);
    ASSERT_LE(std::abs(got.v_mps), 1.2001f);
    ASSERT_LE(std::abs(got.w_radps), 14.001f);
    ASSERT_LE(larger_wheel(got), 1.4001f);
    // Same curvature w / v, and one limit is reached.
    ASSERT_NEAR(got.v_mps * wanted.w_radps, wanted.v_mps * got.w_radps, 1e-3);
    const bool at_limit =
        std::abs(got.v_mps) > 1.1999f || std::abs(got.w_radps) > 13.999f || larger_wheel(got) > 1.3999f;
    ASSERT_TRUE(at_limit || (got.v_mps == wanted.v_mps && got.w_radps == wanted.w_radps));
    limited += at_limit ? 1 : 0;
  }
  EXPECT_GT(limited, 5000);
}

TEST(DriveLimits, NaNGivesZero) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    for (const Twist wanted : {Twist{bad, 0.0f}, Twist{0.5f, bad}}) {
      const Twist got = within_speed_limits(wanted, kDrive);
      EXPECT_EQ(got.v_mps, 0.0f);
      EXPECT_EQ(got.w_radps, 0.0f);
    }
  }
}

TEST(DriveLimits, TheLimitHoldsForThePredictedWheels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-2.0f, 2.0f);
  const auto between = [](float value, float a, float b) {
    return value >= std::min(a, b) - 1e-4f && value <= std::max(a, b) + 1e-4f;
  };
  for (const double lag_s : {0.0, 0.02, 0.08, 0.3}) {
    DriveParameters drive;
    drive.wheel_lag_s = lag_s;
    for (int i = 0; i < 3000; ++i) {
      const Twist wheels = within_speed_limits({any(random), 12.0f * any(random)}, drive);
      const Twist wanted = within_speed_limits({any(random), 12.0f * any(random)}, drive);
      const Twist got = within_acceleration_limit(wanted, wheels, 0.016, drive);
      ASSERT_TRUE(between(got.v_mps, wheels.v_mps, wanted.v_mps));
      ASSERT_TRUE(between(got.w_radps, wheels.w_radps, wanted.w_radps));
      ASSERT_LE(larger_wheel(got), 1.4001f);
      const Twist after = wheels_after(wheels, got, 0.016, drive);
      const WheelSpeeds a = wheels_of(wheels, drive.wheel_base_m), b = wheels_of(after, drive.wheel_base_m);
      ASSERT_LE(std::abs(b.left_mps - a.left_mps), 4.0f * 0.016f + 1e-5f);
      ASSERT_LE(std::abs(b.right_mps - a.right_mps), 4.0f * 0.016f + 1e-5f);
    }
  }
}

TEST(DriveLimits, TheInverseOfTheLagReachesTheWantedSpeedInOnePeriod) {
  const Twist wheels{0.3f, -2.0f}, wanted{0.34f, -1.0f};
  const Twist command = command_for(wanted, wheels, 0.016, kDrive);
  const Twist after = wheels_after(wheels, command, 0.016, kDrive);
  EXPECT_NEAR(after.v_mps, wanted.v_mps, 1e-6f);
  EXPECT_NEAR(after.w_radps, wanted.w_radps, 1e-5f);
  // A limit of the command's own steps would cut this off.
  EXPECT_GT(command.v_mps - wheels.v_mps, 4.0f * 0.016f);
}

TEST(DriveLimits, TheWheelsReachFullSpeedAtTheLimitOfTheirAcceleration) {
  Twist wheels;
  int frames = 0;
  // The last part follows the lag, because the command is limited, too.
  while (wheels.v_mps < 0.85f) {
    const Twist command = within_acceleration_limit({1.2f, 0.0f}, wheels, 0.01, kDrive);
    wheels = wheels_after(wheels, command, 0.01, kDrive);
    ASSERT_LT(++frames, 1000);
  }
  EXPECT_EQ(frames, 22) << "0.85 m/s at 4 m/s^2 in steps of 10 ms";
}

}  // namespace
}  // namespace touchline
