// Positions of rendered objects compared with the lens model.
#include <gtest/gtest.h>

#include "hal/mock/random.h"
#include "tests/mock/black_field.h"

namespace touchline::hal::mock {
namespace {

constexpr std::uint16_t kWidth = 640, kHeight = 480;
constexpr std::size_t kRed = 0, kGreen = 1;

Placement anywhere(Random& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8), random.uniform(-3.1, 3.1)};
}

TEST(Patch, CentroidIsAtTheProjectedPoint) {
  ArenaParameters parameters = black_field();
  parameters.patch[0] = {PatchShape::kSquare, 0.01875, 0.01875, 0.0345, 0.0345};
  Renderer renderer(parameters, kWidth, kHeight);
  Random random(1, 9);
  double worst = 0.0;
  for (int i = 0; i < 60; ++i) {
    const Placement robot = anywhere(random);
    const IntensityMoments moments =
        intensity_moments(renderer.render(stationary(robot), stationary(robot)), kWidth, kRed);
    const Vector2 patch = position(robot) + rotated({0.01875, 0.01875}, robot.theta_rad);
    const auto [u, v] = renderer.lens().project({patch.x, patch.y, parameters.robot_height_m});
    worst = std::max(worst, std::hypot(moments.u - u, moments.v - v));
  }
  EXPECT_LT(worst, 0.1);
}

TEST(Patch, EachShapeHasItsAreaAndCentroid) {
  ArenaParameters parameters = black_field();
  const Placement robot{0.3, -0.2, 0.7};
  // Area of the robot's top in pixels, from the projection of a square around the point.
  const auto area_px = [&](const Renderer& renderer, double area_m2) {
    const auto at = [&](double x, double y) { return renderer.lens().project({x, y, parameters.robot_height_m}); };
    const auto a = at(robot.x_m - 0.01, robot.y_m), b = at(robot.x_m + 0.01, robot.y_m);
    const auto c = at(robot.x_m, robot.y_m - 0.01), d = at(robot.x_m, robot.y_m + 0.01);
    const double determinant = (b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0]);
    return std::abs(determinant) / (0.02 * 0.02) * area_m2;
  };
  const auto check = [&](PatchShape shape, double area_m2) {
    parameters.patch[0] = {shape, 0.004, -0.003, 0.04, 0.03};
    Renderer renderer(parameters, kWidth, kHeight);
    const IntensityMoments moments =
        intensity_moments(renderer.render(stationary(robot), stationary(robot)), kWidth, kRed);
    EXPECT_NEAR(moments.sum, area_px(renderer, area_m2), 0.02 * area_px(renderer, area_m2));
    const Vector2 patch = position(robot) + rotated({0.004, -0.003}, robot.theta_rad);
    const auto [u, v] = renderer.lens().project({patch.x, patch.y, parameters.robot_height_m});
    EXPECT_NEAR(std::hypot(moments.u - u, moments.v - v), 0.0, 0.1);
  };
  check(PatchShape::kSquare, 0.04 * 0.03);
  check(PatchShape::kTriangle, 0.5 * 0.04 * 0.03);
  check(PatchShape::kCircle, std::numbers::pi / 4.0 * 0.04 * 0.04);
}

TEST(Patch, TriangleHasItsBaseBehind) {
  ArenaParameters parameters = black_field();
  parameters.patch[0] = {PatchShape::kTriangle, 0.0, 0.0, 0.06, 0.06};
  Renderer renderer(parameters, kWidth, kHeight);
  const Placement robot{0.0, 0.0, 0.0};
  const auto picture = renderer.render(stationary(robot), stationary(robot));
  const auto lit = [&](double x, double y) {
    const auto [u, v] = renderer.lens().project({x, y, parameters.robot_height_m});
    const auto index = static_cast<std::size_t>(std::lround(v)) * kWidth + static_cast<std::size_t>(std::lround(u));
    return picture[3 * index + kRed] > kWhite / 2;
  };
  EXPECT_TRUE(lit(-0.014, 0.02));
  EXPECT_TRUE(lit(-0.014, -0.02));
  EXPECT_TRUE(lit(0.03, 0.0));
  EXPECT_FALSE(lit(0.02, 0.02));
  EXPECT_FALSE(lit(0.02, -0.02));
}

TEST(Patch, LaterPatchesCoverEarlierOnes) {
  ArenaParameters parameters = black_field();
  parameters.patch = {{PatchShape::kSquare, 0.0, 0.0, 0.06, 0.06}, {PatchShape::kCircle, 0.0, 0.0, 0.03, 0.03}};
  parameters.robot[0].colors = {"green"};
  Renderer renderer(parameters, kWidth, kHeight);
  const auto picture = renderer.render(stationary({}), stationary({}));
  const IntensityMoments red = intensity_moments(picture, kWidth, kRed),
                         green = intensity_moments(picture, kWidth, kGreen);
  const double circle = std::numbers::pi / 4.0 * 0.03 * 0.03, square = 0.06 * 0.06;
  EXPECT_NEAR(red.sum / green.sum, (square - circle) / square, 0.02);
}

// Uses a mask of the ball, because its brightness is uneven. The centroid of one mask is uncertain by a tenth of a
// pixel; the mean of many is not.
TEST(Ball, OutlineIsCenteredOnTheProjection) {
  ArenaParameters parameters = black_field();
  parameters.ball_radius_m = 0.04;
  Renderer renderer(parameters, kWidth, kHeight);
  Random random(2, 9);
  double sum_u = 0.0, sum_v = 0.0, worst = 0.0;
  constexpr int kBalls = 60;
  for (int i = 0; i < kBalls; ++i) {
    Placement ball = anywhere(random);
    const Snapshot all = stationary({9.0, 9.0, 0.0}, ball);
    const auto picture = renderer.render(all, all);
    double u = 0.0, v = 0.0, count = 0.0;
    for (std::size_t k = 0; k < picture.size() / 3; ++k) {
      if (picture[3 * k + kGreen] < kWhite / 4) continue;  // half covered; the edge of the ball has half of the light
      u += static_cast<double>(k % kWidth);
      v += static_cast<double>(k / kWidth);
      ++count;
    }
    ASSERT_GT(count, 100.0);
    const auto [center_u, center_v] = renderer.lens().project({ball.x_m, ball.y_m, parameters.ball_radius_m});
    sum_u += u / count - center_u;
    sum_v += v / count - center_v;
    worst = std::max(worst, std::hypot(u / count - center_u, v / count - center_v));
  }
  EXPECT_NEAR(sum_u / kBalls, 0.0, 0.05);
  EXPECT_NEAR(sum_v / kBalls, 0.0, 0.05);
  EXPECT_LT(worst, 0.3);
}

TEST(Motion, BlurMatchesTheMotion) {
  ArenaParameters parameters = black_field();
  Renderer renderer(parameters, kWidth, kHeight);
  const Placement begin{0.2, 0.1, 0.0}, end{0.24, 0.1, 0.0}, middle{0.22, 0.1, 0.0};
  const IntensityMoments sharp =
      intensity_moments(renderer.render(stationary(middle), stationary(middle)), kWidth, kRed);
  const IntensityMoments blurred = intensity_moments(renderer.render(stationary(begin), stationary(end)), kWidth, kRed);
  EXPECT_NEAR(blurred.sum, sharp.sum, 0.01 * sharp.sum);
  EXPECT_NEAR(blurred.u, sharp.u, 0.1);
  EXPECT_NEAR(blurred.v, sharp.v, 0.1);
  const auto a = renderer.lens().project({begin.x_m, begin.y_m, parameters.robot_height_m});
  const auto b = renderer.lens().project({end.x_m, end.y_m, parameters.robot_height_m});
  // A uniform motion over length d adds d^2 / 12 to the variance.
  EXPECT_NEAR(blurred.variance_u - sharp.variance_u, std::pow(b[0] - a[0], 2.0) / 12.0,
              0.05 * std::pow(b[0] - a[0], 2.0) / 12.0);
  EXPECT_NEAR(blurred.variance_v - sharp.variance_v, std::pow(b[1] - a[1], 2.0) / 12.0, 0.3);
}

TEST(Motion, RotationTakesTheShorterDirection) {
  ArenaParameters parameters = black_field();
  parameters.patch[0] = {PatchShape::kSquare, 0.025, 0.0, 0.01, 0.01};
  Renderer renderer(parameters, kWidth, kHeight);
  const Placement begin{0.0, 0.0, 3.1}, end{0.0, 0.0, -3.1};
  const IntensityMoments moments = intensity_moments(renderer.render(stationary(begin), stationary(end)), kWidth, kRed);
  const auto [u, v] = renderer.lens().project({-0.025, 0.0, parameters.robot_height_m});
  EXPECT_NEAR(std::hypot(moments.u - u, moments.v - v), 0.0, 0.2);
}

// A white square that moves to the right leans: each row shows it where it is at the time of that row.
TEST(Motion, ARollingShutterShowsEachRowAtItsOwnTime) {
  ArenaParameters parameters = black_field();
  parameters.robot_side_m = 0.4;
  parameters.patch[0] = {PatchShape::kSquare, 0.0, 0.0, 0.4, 0.4};
  Renderer renderer(parameters, kWidth, kHeight);
  const Placement begin{-0.1, 0.0, 0.0}, end{0.1, 0.0, 0.0};
  const RowTiming rows{0.9f / (kHeight - 1), 0.1f};
  const auto column_of_row = [](std::span<const std::uint16_t> picture, std::size_t row) {
    double sum = 0.0, moment = 0.0;
    for (std::size_t column = 0; column < kWidth; ++column) {
      const double value = picture[3 * (row * kWidth + column) + kRed];
      sum += value;
      moment += value * static_cast<double>(column);
    }
    return moment / sum;
  };
  constexpr std::array kRows{std::size_t{200}, std::size_t{240}, std::size_t{280}};
  std::array<double, kRows.size()> rolling{};
  const auto picture = renderer.render(stationary(begin), stationary(end), rows);
  for (std::size_t i = 0; i < kRows.size(); ++i) rolling[i] = column_of_row(picture, kRows[i]);
  EXPECT_GT(rolling[2] - rolling[0], 5.0) << "it leans";
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    const double time = 0.9 * static_cast<double>(kRows[i]) / (kHeight - 1) + 0.05;  // middle of the row's exposure
    const Placement then{begin.x_m + time * (end.x_m - begin.x_m), 0.0, 0.0};
    EXPECT_NEAR(rolling[i], column_of_row(renderer.render(stationary(then), stationary(then)), kRows[i]), 0.05);
  }
}

TEST(Picture, OfOddSizeShowsTheSamePart) {
  ArenaParameters parameters = black_field();
  parameters.camera.center_u_px = 8.0;
  parameters.camera.center_v_px = 16.0;
  Renderer renderer(parameters, 17, 33);
  const auto picture = renderer.render(stationary({}), stationary({}));
  ASSERT_EQ(picture.size(), 17U * 33U * 3U);
  const IntensityMoments moments = intensity_moments(picture, 17, kRed);
  const auto [u, v] = renderer.lens().project({0.0, 0.0, parameters.robot_height_m});
  EXPECT_NEAR(moments.u, u, 0.1);
  EXPECT_NEAR(moments.v, v, 0.1);
}

}  // namespace
}  // namespace touchline::hal::mock
