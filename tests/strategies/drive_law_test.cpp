#include "hal/mock/strategies/drive_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::hal::mock {
namespace {

Pose pose(double x, double y, double theta) { return {to_field_point({x, y}), wrap_to_float(theta)}; }

TEST(DriveLaw, DrivesForwardOrBackwardByTheSmallerTurn) {
  const DriveLaw law{0.35, 4.0, 4.0, 0.1};
  const Twist forward = drive_to(pose(0.0, 0.0, 0.0), {1.0, 0.0}, law);
  EXPECT_FLOAT_EQ(forward.v_mps, 0.35f);
  EXPECT_NEAR(forward.w_radps, 0.0, 1e-6);
  const Twist backward = drive_to(pose(0.0, 0.0, 3.0), {1.0, 0.0}, law);
  EXPECT_NEAR(backward.v_mps, -0.35 * std::cos(std::numbers::pi - 3.0), 1e-6);
  EXPECT_NEAR(backward.w_radps, 4.0 * (std::numbers::pi - 3.0), 1e-6) << "turns its back to the target";
  const Twist aside = drive_to(pose(0.0, 0.0, 0.0), {0.0, -1.0}, law);
  EXPECT_NEAR(aside.v_mps, 0.0, 1e-6);
  EXPECT_NEAR(aside.w_radps, -4.0, 1e-6) << "limited";
  const Twist near = drive_to(pose(0.0, 0.0, 0.0), {0.05, 0.0}, law);
  EXPECT_NEAR(near.v_mps, 0.175, 1e-6);
  const Twist there = drive_to(pose(1.0, 0.0, 0.0), {1.0, 0.0}, law);
  EXPECT_EQ(there.v_mps, 0.0f);
}

TEST(DriveLaw, ReturnsToTheLineAndStopsAtThePlace) {
  const DriveLaw law{0.8, 6.0, 14.0, 0.15};
  for (const double theta : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi, 1.0, -2.5}) {
    Vector2 p{0.05, -0.4};
    double heading = theta;
    for (int frame = 0; frame < 250; ++frame) {
      const Twist twist = drive_along(pose(p.x, p.y, heading), {0.0, 0.2}, 0.5 * std::numbers::pi, law);
      p = p + (0.016 * static_cast<double>(twist.v_mps)) * unit_vector(heading);
      heading += 0.016 * static_cast<double>(twist.w_radps);
    }
    EXPECT_NEAR(p.x, 0.0, 0.02) << theta;
    EXPECT_NEAR(p.y, 0.2, 0.01) << theta;
    EXPECT_NEAR(std::abs(std::sin(heading)), 1.0, 0.05) << "stands along the line, from " << theta;
  }
}

}  // namespace
}  // namespace touchline::hal::mock
