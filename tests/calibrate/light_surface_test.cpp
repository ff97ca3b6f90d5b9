#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "hal/mock/lens.h"
#include "tests/calibrate/arena_photograph.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/calibrate/light/light_fit.h"

// Measures the arena's lamps on grey paper, on the floor, and on a floor with robots.
namespace touchline::calibrate {
namespace {

class LightSurfaceOf : public ::testing::Test {
 protected:
  LightSurfaceOf() {
    // A lamp above one half of the field: the light varies by at least 2 : 1.
    arena_.light.lamp = {{-0.8, 0.5, 1.6, 1.0}};
    const hal::mock::Lens lens(arena_.camera);
    const double x = 0.5 * arena_.field.length_m - 0.05, y = 0.5 * arena_.field.width_m - 0.05;
    for (const auto& [cx, cy] : {std::pair{-x, -y}, {x, -y}, {x, y}, {-x, y}}) {
      const auto [u, v] = lens.project({cx, cy, 0.0});
      field_.push_back({static_cast<float>(u), static_cast<float>(v)});
    }
  }

  std::unique_ptr<LightMap> fit(LightSurface surface, std::vector<hal::Picture> pictures) {
    LightFitInput input;
    input.pictures = std::move(pictures);
    input.surface = surface;
    input.region_of_interest = field_;
    auto map = std::make_unique<LightMap>();
    EXPECT_EQ(fit_light(input, *map, report_).text(), "");
    return map;
  }

  // Returns the largest difference between two maps within the field after scaling one of them.
  double worst(const LightMap& a, const LightMap& b) const {
    double sum = 0, worst = 0;
    std::vector<double> ratios;
    for (std::size_t row = 10; row < 38; ++row) {
      for (std::size_t column = 14; column < 50; ++column) {
        const std::size_t i = row * a.columns + column;
        for (std::size_t c = 0; c < 3; ++c) {
          ratios.push_back(std::log(static_cast<double>(a.illumination[c][i] / b.illumination[c][i])));
          sum += ratios.back();
        }
      }
    }
    for (const double r : ratios) worst = std::max(worst, std::abs(r - sum / static_cast<double>(ratios.size())));
    return worst;
  }

  hal::mock::ArenaParameters arena_;
  Polygon field_;
  LightReport report_;
  Result<void> result_;
};

TEST_F(LightSurfaceOf, FieldAndPaperGiveTheSameMap) {
  const auto paper = fit(LightSurface::kGreyPaper, {photograph(arena_, hal::mock::Floor::kGreyPaper, 1)});
  EXPECT_GT(report_.most[1] / report_.least[1], 1.5) << "otherwise there is nothing to correct";
  const auto field = fit(LightSurface::kField, {photograph(arena_, hal::mock::Floor::kField, 2)});
  EXPECT_LT(worst(*paper, *field), 0.03);
  // The check must fail if lines count as floor.
  const auto lines = fit(LightSurface::kGreyPaper, {photograph(arena_, hal::mock::Floor::kField, 2)});
  EXPECT_GT(worst(*paper, *lines), 0.05);
}

TEST_F(LightSurfaceOf, IgnoresMovingObjects) {
  const auto paper = fit(LightSurface::kGreyPaper, {photograph(arena_, hal::mock::Floor::kGreyPaper, 1)});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(-0.9, 0.9), y(-0.7, 0.7);
  std::vector<hal::Picture> pictures;
  for (unsigned i = 0; i < 9; ++i) {
    hal::mock::Snapshot things;
    for (std::size_t k = 0; k < arena_.robot.size(); ++k) things.robots.push_back({x(random), y(random), 0.0});
    pictures.push_back(photograph(arena_, hal::mock::Floor::kField, i, &things));
  }
  const auto moving = fit(LightSurface::kMoving, pictures);
  EXPECT_LT(worst(*paper, *moving), 0.03);
  LightFitInput input;
  input.pictures = {pictures[0], pictures[1]};
  input.surface = LightSurface::kMoving;
  EXPECT_EQ((result_ = fit_light(input, *moving, report_)).code(), ErrorCode::kNotFound);
}

TEST_F(LightSurfaceOf, BorderGivesTintAndGradient) {
  // One distant lamp, whose light the border can show.
  arena_.light.lamp = {{-3.0, 1.0, 3.0, 1.0}};
  const hal::mock::Lens lens(arena_.camera);
  FieldFitInput points;
  points.width_px = kWidth;
  points.height_px = kHeight;
  points.camera_height_m = arena_.camera.position_m[2];
  for (double x = -1.0; x <= 1.01; x += 0.5) {
    for (double y = -0.8; y <= 0.81; y += 0.4) {
      const auto [u, v] = lens.project({x, y, 0.0});
      points.points.push_back({x, y, u, v});
    }
  }
  FieldFit camera_fit;
  ASSERT_EQ(fit_field(points, camera_fit).text(), "");
  CameraModel camera;
  ASSERT_TRUE(camera.configure(camera_fit.camera).ok());

  const auto paper = fit(LightSurface::kGreyPaper, {photograph(arena_, hal::mock::Floor::kGreyPaper, 1)});
  LightFitInput input;
  input.pictures = {photograph(arena_, hal::mock::Floor::kField, 2)};
  input.surface = LightSurface::kBorder;
  input.region_of_interest = field_;
  input.border = border_places(camera, FieldParameters{}, kWidth, kHeight);
  EXPECT_GT(input.border.size(), 200U);
  LightMap border;
  ASSERT_EQ(fit_light(input, border, report_).text(), "");
  EXPECT_GT(report_.most[1] / report_.least[1], 1.3) << "otherwise there is nothing to correct";
  EXPECT_LT(worst(*paper, border), 0.06);

  // The same camera in yellower, dimmer light. The normalization C of the first map is kept, so the new map shows the
  // change of the light.
  input.normal = report_.normal;
  const std::array<double, 3> left = {0.8, 0.7, 0.5};
  hal::Picture& picture = input.pictures[0];
  for (std::size_t i = 0; i < picture.rgb8.size(); ++i) {
    picture.rgb8[i] = static_cast<std::uint8_t>(std::lround(picture.rgb8[i] * left[i % 3]));
  }
  // The shadow of a robot covers a part of the border.
  for (std::size_t i = 0; i < input.border.size(); i += 6) {
    for (const std::size_t pixel : input.border[i]) picture.rgb8[3 * pixel] = picture.rgb8[3 * pixel + 1] = 20;
  }
  LightMap dimmer;
  ASSERT_EQ(fit_light(input, dimmer, report_).text(), "");
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t middle = 24 * 64 + 32;
    EXPECT_NEAR(static_cast<double>(dimmer.illumination[c][middle] / border.illumination[c][middle]), left[c], 0.02);
  }

  input.border.resize(30);
  EXPECT_EQ((result_ = fit_light(input, dimmer, report_)).code(), ErrorCode::kNotFound);
  EXPECT_NE(result_.text().find("border"), std::string::npos) << result_.text();
}

TEST(LightReport, ListsSaturatedAndDarkSpots) {
  LightFitInput input;
  input.pictures.emplace_back();
  hal::Picture& picture = input.pictures[0];
  picture.width_px = 320;
  picture.height_px = 240;
  picture.rgb8.assign(std::size_t{3} * 320 * 240, 120);
  for (std::size_t v = 50; v < 100; ++v) {
    for (std::size_t c = 3 * 100; c < 3 * 200; ++c) picture.rgb8[3 * v * 320 + c] = 255;
    for (std::size_t c = 3 * 250; c < 3 * 270; ++c) picture.rgb8[3 * v * 320 + c] = 3;
  }
  auto map = std::make_unique<LightMap>();
  LightReport report;
  ASSERT_EQ(fit_light(input, *map, report).text(), "");
  ASSERT_EQ(report.spots.size(), 2U);
  EXPECT_TRUE(report.spots[0].saturated);
  EXPECT_EQ(report.spots[0].left_px, 100U);
  EXPECT_EQ(report.spots[0].right_px, 199U);
  EXPECT_EQ(report.spots[0].top_px, 50U);
  EXPECT_EQ(report.spots[0].bottom_px, 99U);
  EXPECT_EQ(report.spots[0].cells, report.saturated_cells);
  EXPECT_FALSE(report.spots[1].saturated);
  EXPECT_EQ(report.spots[1].left_px, 250U);
}

}  // namespace
}  // namespace touchline::calibrate
