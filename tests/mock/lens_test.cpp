#include "hal/mock/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hal/mock/random.h"

namespace touchline::hal::mock {
namespace {

// Looks straight down from 2 m, so that the angle to the axis follows from the position on the floor.
LensParameters straight_down() {
  LensParameters parameters;
  parameters.position_m = {0.0, 0.0, 2.0};
  parameters.roll_rad = 0.0;
  parameters.center_u_px = 320.0;
  parameters.center_v_px = 240.0;
  return parameters;
}

TEST(Lens, RadiusFollowsTheModel) {
  for (const double cubic : {-0.1, 0.0, 0.3}) {
    LensParameters parameters = straight_down();
    parameters.cubic = cubic;
    const Lens lens(parameters);
    for (const double angle : {0.1, 0.5, 1.0, 1.3}) {
      const auto [u, v] = lens.project({2.0 * std::tan(angle), 0.0, 0.0});
      EXPECT_NEAR(u - 320.0, 560.0 * (angle + cubic * angle * angle * angle), 1e-9);
      EXPECT_NEAR(v, 240.0, 1e-9);
    }
  }
}

TEST(Lens, ImageAxesMatchTheFieldAxes) {
  const Lens lens(straight_down());
  EXPECT_GT(lens.project({0.5, 0.0, 0.0})[0], 320.0) << "x points to the right";
  EXPECT_LT(lens.project({0.0, 0.5, 0.0})[1], 240.0) << "y points up";
  // Closer objects appear larger.
  EXPECT_GT(lens.project({0.5, 0.0, 0.5})[0], lens.project({0.5, 0.0, 0.0})[0]);
}

TEST(Lens, RollTurnsThePicture) {
  LensParameters parameters = straight_down();
  parameters.roll_rad = 0.3;
  const auto turned = Lens(parameters).project({0.5, 0.0, 0.0});
  const auto upright = Lens(straight_down()).project({0.5, 0.0, 0.0});
  EXPECT_NEAR(std::hypot(turned[0] - 320.0, turned[1] - 240.0), upright[0] - 320.0, 1e-9);
  EXPECT_NEAR(std::abs(std::atan2(turned[1] - 240.0, turned[0] - 320.0)), 0.3, 1e-9);
}

TEST(Lens, LooksAtTheAimPoint) {
  LensParameters parameters;
  parameters.aim_m = {0.3, -0.2};
  const Lens lens(parameters);
  const auto [u, v] = lens.project({0.3, -0.2, 0.0});
  EXPECT_NEAR(u, parameters.center_u_px, 1e-9);
  EXPECT_NEAR(v, parameters.center_v_px, 1e-9);
}

TEST(Lens, UnprojectIsTheInverseOfProject) {
  Random random(1, 1);
  for (const double cubic : {-0.2, -0.03, 0.0, 1.0}) {
    LensParameters parameters;
    parameters.cubic = cubic;
    parameters.roll_rad = 0.7;
    const Lens lens(parameters);
    const Vec3 eye = lens.position_m();
    for (int i = 0; i < 2000; ++i) {
      const Vec3 point{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(0.0, 0.3)};
      const auto [u, v] = lens.project(point);
      const Vec3 sight = lens.unproject(u, v);
      const Vec3 away{point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]};
      const double distance = std::sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
      for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(sight[k], away[k] / distance, 1e-10) << cubic;
    }
  }
}

// With a negative cubic term the radius has a maximum. Pixels beyond it must give the direction of the maximum.
TEST(Lens, PixelsBeyondTheWidestAngleHaveADirectionToo) {
  for (const double cubic : {-0.2, -0.03, 0.0, 1.0}) {
    LensParameters parameters = straight_down();
    parameters.cubic = cubic;
    parameters.focal_px = 10.0;
    const Lens lens(parameters);
    const double widest = cubic < 0.0 ? std::min(std::numbers::pi, std::sqrt(-1.0 / (3.0 * cubic))) : std::numbers::pi;
    double before = 1.0;
    for (int radius = 0; radius <= 3000; ++radius) {
      const Vec3 sight = lens.unproject(320.0 + radius, 240.0);
      ASSERT_NEAR(sight[0] * sight[0] + sight[1] * sight[1] + sight[2] * sight[2], 1.0, 1e-12);
      ASSERT_LE(-sight[2], before + 1e-12) << "the angle must grow with the radius";
      ASSERT_GE(-sight[2], std::cos(widest) - 1e-9);
      before = -sight[2];
    }
    EXPECT_NEAR(before, std::cos(widest), 1e-6) << cubic;
  }
}

TEST(Lens, CenterPixelIsOnTheOpticalAxis) {
  const Lens lens(straight_down());
  const Vec3 sight = lens.unproject(320.0, 240.0);
  EXPECT_NEAR(sight[2], -1.0, 1e-15);
  EXPECT_EQ(lens.project({0.0, 0.0, 0.0}), (std::array<double, 2>{320.0, 240.0}));
}

}  // namespace
}  // namespace touchline::hal::mock
