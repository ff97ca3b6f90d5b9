#include "hal/mock/strategies/univector_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "hal/mock/random.h"

namespace touchline::hal::mock {
namespace {

TEST(UnivectorField, HasTheTargetsDirectionAtTheTarget) {
  for (const Spirals spirals : {Spirals::kBoth, Spirals::kLeft, Spirals::kRight}) {
    for (const double direction : {0.0, 1.0, -2.0, 3.1}) {
      const FieldTarget target{{0.3, -0.2}, direction, spirals};
      EXPECT_NEAR(wrap_angle(direction_to_target(target.place, target) - direction), 0.0, 1e-9);
    }
  }
}

TEST(UnivectorField, HasTheValuesOfItsEquation) {
  // Straight behind the target, both spirals together point along the target's direction.
  const FieldTarget target{{0.0, 0.0}, 0.0};
  EXPECT_NEAR(direction_to_target({-0.5, 0.0}, target), 0.0, 1e-9);
  // Above the left spiral: theta + pi/2 (2 - (d_e + K_r) / (rho + K_r)) with rho 0.4463, theta pi/2.
  const double turn = 2.0 - (0.0537 + 0.0415) / (0.4463 + 0.0415);
  EXPECT_NEAR(wrap_angle(direction_to_target({0.0, 0.5}, target) - 0.5 * std::numbers::pi * (1.0 + turn)), 0.0, 1e-9);
  // Inside the circle: theta + pi/2 sqrt(rho / d_e).
  const FieldTarget left{{0.0, 0.0}, 0.0, Spirals::kLeft};
  EXPECT_NEAR(direction_to_target({0.02, 0.0537}, left), 0.5 * std::numbers::pi * std::sqrt(0.02 / 0.0537), 1e-9);
}

// Follows the field in steps of 2 mm. Returns the distance from the target when a line leaves it again, and the
// difference of the directions there.
struct Arrival {
  double distance_m = 1e9, off_rad = 0.0;
};
template <class Direction>
Arrival follow_field(Vector2 p, const FieldTarget& target, Direction direction) {
  Arrival arrival;
  for (int step = 0; step < 3000; ++step) {
    const double theta = direction(p);
    const double d = distance(p, target.place);
    if (d < arrival.distance_m) arrival = {d, std::abs(wrap_angle(theta - target.direction_rad))};
    p = p + 0.002 * unit_vector(theta);
  }
  return arrival;
}

TEST(UnivectorField, LeadsFromEverywhereToTheTargetInItsDirection) {
  Random random(1, 1);
  for (int run = 0; run < 100; ++run) {
    const FieldTarget target{{0.4, 0.3}, random.uniform(-3.0, 3.0)};
    const Vector2 start{random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8)};
    const Arrival arrival = follow_field(start, target, [&](Vector2 p) { return direction_to_target(p, target); });
    EXPECT_LT(arrival.distance_m, 0.01) << run;
    EXPECT_LT(arrival.off_rad, 0.3) << run;
  }
}

TEST(UnivectorField, AvoidsAnObstacleOnTheWay) {
  const FieldTarget target{{0.8, 0.0}, 0.0};
  const MovingObstacle obstacle{{0.0, 0.01}, {}};
  double nearest = 1e9;
  const auto direction = [&](Vector2 p) {
    nearest = std::min(nearest, distance(p, obstacle.position));
    return avoiding_direction(p, direction_to_target(p, target), {}, {&obstacle, 1}, {});
  };
  EXPECT_LT(follow_field({-0.8, 0.0}, target, direction).distance_m, 0.01);
  EXPECT_GT(nearest, 0.075) << "the robots do not touch";
  EXPECT_LT(nearest, 0.2) << "otherwise there was nothing to avoid";
}

TEST(UnivectorField, ShiftsAnObstacleByItsMotion) {
  const Vector2 here{0.0, 0.0};
  const MovingObstacle still{{0.3, 0.0}, {}}, coming{{0.3, 0.0}, {-1.5, 0.0}}, fast{{0.3, 0.0}, {-9.0, 0.0}};
  EXPECT_NEAR(avoiding_direction(here, 1.0, {}, {&still, 1}, {}), 1.0, 1e-3) << "too far to matter";
  EXPECT_GT(avoiding_direction(here, 1.0, {}, {&coming, 1}, {}), 1.5) << "0.18 m nearer";
  EXPECT_TRUE(std::isfinite(avoiding_direction(here, 1.0, {}, {&fast, 1}, {}))) << "at most at the robot itself";
  EXPECT_EQ(avoiding_direction(here, 1.0, {}, {}, {}), 1.0);
}

}  // namespace
}  // namespace touchline::hal::mock
