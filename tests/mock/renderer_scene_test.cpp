// Occlusion, the floor, and consecutive frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "hal/mock/random.h"
#include "tests/mock/black_field.h"

namespace touchline::hal::mock {
namespace {

constexpr std::uint16_t kSceneWidth = 640, kSceneHeight = 480;
constexpr std::size_t kSceneRed = 0, kSceneGreen = 1;

// The camera looks along x from a low position beside the field, so that closer objects hide much.
ArenaParameters low_camera() {
  ArenaParameters parameters = black_field();
  parameters.camera.position_m = {-1.6, 0.0, 0.8};
  return parameters;
}

double green_of(Renderer& renderer, const Snapshot& all) {
  return intensity_moments(renderer.render(all, all), kSceneWidth, kSceneGreen).sum;
}

TEST(Occlusion, RobotHidesOnlyABallBehindIt) {
  const ArenaParameters parameters = low_camera();
  Renderer renderer(parameters, kSceneWidth, kSceneHeight);
  const Placement robot{0.0, 0.0, 0.0}, away{9.0, 9.0, 0.0};
  const double patch = green_of(renderer, stationary(robot));  // white also contains green
  const double behind = green_of(renderer, stationary(robot, {0.075, 0.0, 0.0}));
  EXPECT_NEAR(behind, patch, 1e-9);
  const double ball_alone = green_of(renderer, stationary(away, {-0.075, 0.0, 0.0}));
  ASSERT_GT(ball_alone, 20.0);
  EXPECT_NEAR(green_of(renderer, stationary(robot, {-0.075, 0.0, 0.0})), patch + ball_alone, 1e-3 * patch);
}

TEST(Occlusion, OrderInTheListDoesNotMatter) {
  ArenaParameters parameters = low_camera();
  parameters.body_rgb = {200, 100, 50};
  parameters.robot.push_back(parameters.robot[0]);
  parameters.robot[1].id = 1;
  Renderer renderer(parameters, kSceneWidth, kSceneHeight);
  const Placement near{0.0, 0.0, 0.3}, far{0.09, 0.02, 0.1};  // its side is partly hidden by the closer robot's top
  const auto draw = [&](const Placement& first, const Placement& second) {
    Snapshot all = stationary(first);
    all.robots.push_back(second);
    const auto picture = renderer.render(all, all);
    return std::vector<std::uint16_t>(picture.begin(), picture.end());
  };
  EXPECT_EQ(draw(near, far), draw(far, near));
  const auto light = [](const std::vector<std::uint16_t>& picture) {
    return intensity_moments(picture, kSceneWidth, kSceneRed).sum;
  };
  const Placement away{9.0, 9.0, 0.0};
  const double apart = light(draw(near, away)) + light(draw(away, far));
  EXPECT_LT(light(draw(near, far)), 0.98 * apart) << "nothing is hidden";
}

TEST(Occlusion, LargeBallHidesOnlyObjectsBehindIt) {
  ArenaParameters parameters = low_camera();
  parameters.ball_radius_m = 0.2;
  Renderer renderer(parameters, kSceneWidth, kSceneHeight);
  const auto patch = [&](double ball_x) {
    const Snapshot all = stationary({0.5, 0.0, 0.0}, {ball_x, 0.0, 0.0});
    return intensity_moments(renderer.render(all, all), kSceneWidth, kSceneRed).sum;
  };
  const double alone = patch(9.0);
  ASSERT_GT(alone, 50.0);
  EXPECT_EQ(patch(0.2), 0.0);
  EXPECT_EQ(patch(0.8), alone);
}

TEST(Occlusion, SidesOfARobotAreDarkerThanItsTop) {
  ArenaParameters parameters = low_camera();
  parameters.body_rgb = {255, 255, 255};
  parameters.patch[0] = {PatchShape::kSquare, 0.0, 0.0, 0.001, 0.001};
  Renderer renderer(parameters, kSceneWidth, kSceneHeight);
  const Snapshot all = stationary({});
  const auto picture = renderer.render(all, all);
  const auto light_at = [&](double x, double z) {
    const auto [u, v] = renderer.lens().project({x, 0.0, z});
    return picture[3 * (static_cast<std::size_t>(std::lround(v)) * kSceneWidth +
                        static_cast<std::size_t>(std::lround(u)))] /
           kWhite;
  };
  EXPECT_NEAR(light_at(0.0, 0.075), 1.0, 1e-3);
  const double front = light_at(-0.0375, 0.04);
  EXPECT_LT(front, 0.6);
  EXPECT_GT(front, 0.3);
}

TEST(Frames, NothingRemainsOfEarlierFrames) {
  ArenaParameters parameters;  // the whole arena with lamps, lines and floor texture
  parameters.robot.resize(4);
  Renderer used(parameters, 320, 240), fresh(parameters, 320, 240);
  Random random(4, 9);
  const auto draw = [&] {
    Snapshot all;
    for (int i = 0; i < 4; ++i) {
      all.robots.push_back({random.uniform(-1.2, 1.2), random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)});
    }
    all.ball = {random.uniform(-1.2, 1.2), random.uniform(-1.0, 1.0), 0.0};
    return all;
  };
  for (int i = 0; i < 30; ++i) {
    const Snapshot all = draw(), then = draw();
    const auto a = used.render(all, then);
    Renderer new_one(parameters, 320, 240);
    const auto b = new_one.render(all, then);
    ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << i;
  }
  Snapshot nothing;
  nothing.ball = {50.0, 50.0, 0.0};
  const auto cleared = used.render(nothing, nothing), floor = fresh.render_floor();
  EXPECT_TRUE(std::equal(cleared.begin(), cleared.end(), floor.begin(), floor.end()));
}

class FloorPicture : public ::testing::Test {
 protected:
  FloorPicture() {
    parameters_.light.lamp.clear();
    parameters_.camera.vignetting = 0.0;
    parameters_.field.floor_rgb = {40, 40, 40};
    parameters_.field.line_rgb = {250, 250, 250};
    parameters_.field.outside_rgb = {130, 130, 130};
  }

  // For a pixel on a single surface, within the 3 % of the floor texture.
  void expect(double x, double y, const Srgb& rgb) {
    const auto [u, v] = renderer().lens().project({x, y, 0.0});
    const auto index =
        static_cast<std::size_t>(std::lround(v)) * kSceneWidth + static_cast<std::size_t>(std::lround(u));
    const auto expected = static_cast<double>(reflectance(rgb)[0]);
    EXPECT_NEAR(renderer().render_floor()[3 * index] / kWhite, expected, 0.035 * expected) << x << ' ' << y;
  }
  Renderer& renderer() {
    if (!renderer_) renderer_.emplace(parameters_, kSceneWidth, kSceneHeight);
    return *renderer_;
  }

  ArenaParameters parameters_ = noise_free_arena();
  std::optional<Renderer> renderer_;
};

TEST_F(FloorPicture, LinesAreWhereTheyShouldBe) {
  parameters_.field.line_m = 0.04;  // 10 pixels wide, so that some pixels are entirely on the line
  parameters_.field.border_m = 0.05;
  const Srgb line = parameters_.field.line_rgb, floor = parameters_.field.floor_rgb,
             outside = parameters_.field.outside_rgb;
  expect(0.0, 0.5, line);
  expect(0.03, 0.5, floor);
  expect(-0.03, 0.5, floor);
  for (const double angle : {0.4, 1.2, 2.0, 4.0}) {
    expect(0.25 * std::cos(angle), 0.25 * std::sin(angle), line);
    expect(0.22 * std::cos(angle), 0.22 * std::sin(angle), floor);
    expect(0.28 * std::cos(angle), 0.28 * std::sin(angle), floor);
  }
  for (const double side : {-1.0, 1.0}) {
    expect(0.6, side * 0.89, floor);
    expect(0.6, side * 0.925, line);  // border
    expect(0.6, side * 0.96, outside);
    expect(side * 1.09, 0.5, floor);
    expect(side * 1.125, 0.5, line);
    expect(side * 1.12, 0.0, line);   // goal line
    expect(side * 1.19, 0.0, floor);  // in the goal
    expect(side * 1.275, 0.0, line);  // its back
    expect(side * 1.31, 0.0, outside);
    expect(side * 1.09, 0.89, line);  // corner piece
    expect(side * 1.05, 0.85, floor);
  }
}

TEST_F(FloorPicture, CenterLineIsStraightUnderTheLens) {
  const auto floor = renderer().render_floor();
  const double dark = static_cast<double>(reflectance(parameters_.field.floor_rgb)[0]) * kWhite;
  double worst = 0.0;
  for (const double y : {-0.7, -0.4, 0.4, 0.6, 0.8}) {
    const auto [u, v] = renderer().lens().project({0.0, y, 0.0});
    // Position of the line in the nearest pixel row, from the brightness above that of the floor.
    const auto row = static_cast<std::size_t>(std::lround(v));
    double sum = 0.0, moment = 0.0;
    for (auto column = static_cast<std::size_t>(std::lround(u)) - 4;
         column < static_cast<std::size_t>(std::lround(u)) + 5; ++column) {
      const double above = std::max(0.0, floor[3 * (row * kSceneWidth + column)] - 1.05 * dark);
      sum += above;
      moment += above * static_cast<double>(column);
    }
    // Position of the line in this row according to the lens.
    const auto up = renderer().lens().project({0.0, y + 0.01, 0.0});
    const double expected = u + (static_cast<double>(row) - v) / (up[1] - v) * (up[0] - u);
    worst = std::max(worst, std::abs(moment / sum - expected));
  }
  EXPECT_LT(worst, 0.1);
}

TEST(Paper, IsGreyEverywhereAndVignettingDarkensCorners) {
  ArenaParameters parameters = noise_free_arena();
  parameters.light.lamp.clear();
  parameters.camera.vignetting = 0.4;
  Renderer renderer(parameters, 101, 81, Floor::kGreyPaper);
  const auto paper = renderer.render_floor();
  const auto around = [&](std::size_t u, std::size_t v) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 25; ++i) sum += paper[3 * ((v + i / 5) * 101 + u + i % 5)] / 25.0;
    return sum / kWhite;
  };
  EXPECT_NEAR(around(48, 38), 0.45, 0.01);
  // All four corners are equal. The center of the 5 x 5 pixels is at 0.96 of the distance to the corner.
  const double corner = 0.45 * (1.0 - 0.4 * (48.0 * 48.0 + 38.0 * 38.0) / (50.5 * 50.5 + 40.5 * 40.5));
  EXPECT_NEAR(around(0, 0), corner, 0.01);
  EXPECT_NEAR(around(96, 0), corner, 0.01);
  EXPECT_NEAR(around(0, 76), corner, 0.01);
  EXPECT_NEAR(around(96, 76), corner, 0.01);
}

TEST(Dark, IsBlack) {
  Renderer renderer(noise_free_arena(), 32, 24);
  for (const std::uint16_t value : renderer.render_dark()) ASSERT_EQ(value, 0);
  EXPECT_EQ(renderer.render_dark().size(), 32U * 24U * 3U);
}

TEST(Light, LampsIlluminateTopsWithinFullScale) {
  ArenaParameters parameters = black_field();
  parameters.light.lamp = {{0.8, 0.0, 1.5, 1.0}};
  parameters.light.ambient = 0.1;
  Renderer renderer(parameters, kSceneWidth, kSceneHeight);
  const Lighting lighting(parameters.light, parameters.field);
  const auto height = static_cast<float>(parameters.robot_height_m);
  for (const double x : {-0.8, 0.0, 0.4}) {
    const Snapshot all = stationary({x, 0.0, 0.0});
    const auto [u, v] = renderer.lens().project({x, 0.0, parameters.robot_height_m});
    const auto index =
        static_cast<std::size_t>(std::lround(v)) * kSceneWidth + static_cast<std::size_t>(std::lround(u));
    const double expected = static_cast<double>(lighting.irradiance(static_cast<float>(x), 0.0f, height));
    EXPECT_NEAR(renderer.render(all, all)[3 * index] / kWhite, std::min(expected, 1.0 / 0.9), 0.01 * expected) << x;
  }
  parameters.light.exposure = 20.0;
  Renderer bright(parameters, kSceneWidth, kSceneHeight);
  const Snapshot all = stationary({0.7, 0.0, 0.0});
  const auto picture = bright.render(all, all);
  EXPECT_EQ(*std::max_element(picture.begin(), picture.end()), kLinearScale);
}

}  // namespace
}  // namespace touchline::hal::mock
