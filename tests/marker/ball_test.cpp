#include <gtest/gtest.h>

#include <numbers>

#include "tests/marker/painted_field.h"

namespace touchline::testing {
namespace {

class Ball : public ::testing::TestWithParam<CameraParameters (*)()> {
 protected:
  MarkerParameters parameters = paper_teams();
  PaintedField field{GetParam()(), parameters};
  PortableRandom random{51};
};

TEST_P(Ball, IsSeenWhereItIs) {
  for (int n = 0; n < 100; ++n) {
    const FieldPoint at{random.real(-1.05f, 1.05f), random.real(-0.85f, 0.85f)};
    field.clear();
    field.paint_ball(at);
    const Sightings& seen = field.match();
    ASSERT_TRUE(seen.ball.seen) << n;
    EXPECT_LT(distance_m(seen.ball.position, at), 0.001f) << n;
    EXPECT_GT(seen.ball.area_px, 50u);
    EXPECT_TRUE(seen.robots.empty());
  }
}

// The ball touches a robot. Its top hides a part of the ball from a camera beside it.
TEST_P(Ball, IsSeenWhileHalfOfItIsVisible) {
  const auto orange = [this] { return field.pixels_of(kOrange); };
  int half_hidden = 0;
  for (int n = 0; n < 100; ++n) {
    const Placed robot{Team::kOwn,
                       0,
                       {{random.real(-0.8f, 0.8f), random.real(-0.6f, 0.6f)},
                        random.real(-std::numbers::pi_v<float>, std::numbers::pi_v<float>)}};
    const FieldPoint at = on_field(robot.pose, 0.0375f + parameters.ball.radius_m, random.real(-0.02f, 0.02f));
    field.clear();
    field.paint_ball(at);
    const auto whole = orange();
    field.paint_part(robot, {-0.0375f, -0.0375f}, {0.0375f, 0.0375f}, kBackground);
    field.paint(robot);
    const auto visible = orange();
    if (2 * visible < whole) continue;
    half_hidden += visible < whole ? 1 : 0;
    const Sightings& seen = field.match();
    ASSERT_TRUE(seen.ball.seen) << n;
    EXPECT_LT(distance_m(seen.ball.position, at), 0.012f) << n;
    ASSERT_EQ(seen.robots.size(), 1u);
    EXPECT_EQ(seen.robots[0].id, 0);
  }
  EXPECT_GT(half_hidden, 15);
}

TEST_P(Ball, IsNotASmallLongOrHugeRegion) {
  const Placed somewhere{Team::kOwn, 0, {{0.2f, 0.1f}, 0.5f}};
  field.paint_part(somewhere, {0.0f, 0.0f}, {0.012f, 0.012f}, kOrange);
  EXPECT_FALSE(field.match().ball.seen);
  EXPECT_EQ(field.verdict_at(on_field(somewhere.pose, 0.006f, 0.006f), 0.075f), Verdict::kTooSmall);
  field.clear();
  field.paint_part(somewhere, {-0.08f, 0.0f}, {0.08f, 0.008f}, kOrange);
  EXPECT_FALSE(field.match().ball.seen);
  EXPECT_EQ(field.verdict_at(on_field(somewhere.pose, 0.0f, 0.004f), 0.075f), Verdict::kWrongShape);
  field.clear();
  field.paint_part(somewhere, {-0.08f, -0.08f}, {0.08f, 0.08f}, kOrange);
  EXPECT_FALSE(field.match().ball.seen);
  EXPECT_EQ(field.verdict_at(somewhere.pose.position, 0.075f), Verdict::kTooLarge);
}

TEST_P(Ball, AmbiguousBallsAreNotReported) {
  field.paint_ball({0.3f, 0.3f});
  field.paint_ball({-0.3f, 0.2f});
  EXPECT_FALSE(field.match().ball.seen);
}

// A larger ball is preferred to a small region of its color, and one on the field to one on a robot's top.
TEST_P(Ball, TheMoreLikelyOneIsReported) {
  const Placed robot{Team::kOwn, 2, {{-0.3f, 0.2f}, 1.0f}};
  field.paint(robot);
  field.paint_part(robot, {0.002f, -0.036f}, {0.036f, -0.002f}, kOrange);
  field.paint_ball({0.3f, 0.3f});
  const Sightings& seen = field.match();
  ASSERT_TRUE(seen.ball.seen);
  EXPECT_LT(distance_m(seen.ball.position, {0.3f, 0.3f}), 0.001f);
}

TEST_P(Ball, IsNotSearchedWithoutAColor) {
  parameters.ball.color = kBackground;
  PaintedField without(GetParam()(), parameters);
  field.paint_ball({0.3f, 0.3f});
  without.grid() = field.grid();
  EXPECT_FALSE(without.match().ball.seen);
}

TEST_P(Ball, OutsideTheFieldIsNotReported) {
  field.paint_ball({0.0f, 1.05f});
  EXPECT_FALSE(field.match().ball.seen);
}

INSTANTIATE_TEST_SUITE_P(Camera, Ball, ::testing::Values(straight_camera, tilted_camera),
                         [](const auto& camera) { return camera.param == straight_camera ? "straight" : "tilted"; });

}  // namespace
}  // namespace touchline::testing
