#include "tools/programs/calibrate/light/light_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "firmware/config/light_map_file.h"
#include "tests/results.h"

namespace touchline::calibrate {
namespace {

constexpr std::uint32_t kPictureWidth = 320, kPictureHeight = 240;

// One lamp above the middle.
double lamp(double u, double v) {
  const double x = (u - 160) / 200, y = (v - 120) / 200;
  return 1.0 / std::pow(1.0 + x * x + y * y, 1.5);
}

hal::Picture grey_picture(double brightness, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 3.0);
  hal::Picture picture;
  picture.width_px = kPictureWidth;
  picture.height_px = kPictureHeight;
  for (std::uint32_t v = 0; v < kPictureHeight; ++v) {
    for (std::uint32_t u = 0; u < kPictureWidth; ++u) {
      for (int c = 0; c < 3; ++c) {
        const double value = brightness * (1.0 - 0.1 * c) * lamp(u, v) + noise(random);
        picture.rgb8.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))));
      }
    }
  }
  return picture;
}

LightFitInput of(std::vector<hal::Picture> pictures, const Polygon& region = {}) {
  LightFitInput input;
  input.pictures = std::move(pictures);
  input.region_of_interest = region;
  return input;
}

float cell(const LightMap& map, std::size_t channel, double u, double v) {
  const auto column = static_cast<std::size_t>(u * map.columns / kPictureWidth);
  const auto row = static_cast<std::size_t>(v * map.rows / kPictureHeight);
  return map.illumination[channel][row * map.columns + column];
}

TEST(LightFit, MeasuresTheLampAndIgnoresStainsAndTint) {
  std::vector<hal::Picture> pictures = {grey_picture(220, 1), grey_picture(220, 2)};
  // A dark line that is narrower than half a cell, and a white mark.
  for (hal::Picture& p : pictures) {
    for (std::uint32_t v = 0; v < kPictureHeight; ++v) {
      for (std::uint32_t c = 0; c < 3; ++c) p.rgb8[3 * (v * kPictureWidth + 101) + c] = 0;
    }
    for (std::uint32_t c = 0; c < 3; ++c) p.rgb8[3 * (60 * kPictureWidth + 60) + c] = 255;
  }
  auto map = std::make_unique<LightMap>();
  LightReport report;
  ASSERT_EQ(fit_light(of(pictures), *map, report).text(), "");
  EXPECT_EQ(map->columns, 64);
  EXPECT_EQ(map->rows, 48);
  EXPECT_EQ(report.saturated_cells, 0U);
  EXPECT_EQ(report.dark_cells, 0U);
  // C is the median: half of the cells are brighter than it.
  std::size_t brighter = 0;
  for (std::size_t i = 0; i < 64 * 48; ++i) brighter += map->illumination[0][i] > 1.0f ? 1U : 0U;
  EXPECT_NEAR(static_cast<double>(brighter), 64 * 24, 40);
  for (const auto& [u, v] : {std::pair{20.0, 20.0}, {160.0, 120.0}, {300.0, 60.0}, {101.0, 200.0}, {60.0, 60.0}}) {
    const double expected = lamp(u, v) / lamp(160, 120);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(static_cast<double>(cell(*map, c, u, v) / cell(*map, c, 160, 120)), expected, 0.025) << u << " " << c;
    }
  }
}

TEST(LightFit, LimitsTheBrightestCellToTheRangeOfTheFile) {
  // Half of the picture is four times as bright as the other: the ratio to the median does not fit into 16 bits.
  hal::Picture picture = grey_picture(0, 3);
  for (std::size_t i = 0; i < picture.rgb8.size(); ++i) {
    picture.rgb8[i] = (i / 3) % kPictureWidth < 3 * kPictureWidth / 4 ? std::uint8_t{50} : std::uint8_t{200};
  }
  auto map = std::make_unique<LightMap>();
  LightReport report;
  ASSERT_EQ(fit_light(of({picture}), *map, report).text(), "");
  EXPECT_NEAR(static_cast<double>(cell(*map, 0, 300, 120) / cell(*map, 0, 20, 120)), 4.0, 0.01);
  EXPECT_LE(cell(*map, 0, 300, 120), 2.0f);
  EXPECT_GT(cell(*map, 0, 300, 120), 1.99f);
}

TEST(LightFit, RejectsPicturesThatCannotBeMeasured) {
  auto map = std::make_unique<LightMap>();
  LightReport report;
  Result<void> result;
  ASSERT_EQ(fit_light(of({grey_picture(330, 4)}), *map, report).text(), "");
  EXPECT_GT(report.saturated_cells, 300U);
  EXPECT_LT(report.saturated_cells, 1536U);
  EXPECT_EQ((result = fit_light(of({grey_picture(2000, 5)}), *map, report)).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ((result = fit_light(of({grey_picture(8, 6)}), *map, report)).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ((result = fit_light(of({}), *map, report)).code(), ErrorCode::kOutOfRange);
  LightFitInput other = of({grey_picture(200, 7)});
  other.normal = {20, 20, 20};
  EXPECT_EQ((result = fit_light(other, *map, report)).code(), ErrorCode::kOutOfRange);
  EXPECT_NE(result.text().find("learn the colors again"), std::string::npos) << result.text();
  hal::Picture small = grey_picture(200, 7);
  small.height_px = kPictureHeight / 2;
  small.rgb8.resize(small.rgb8.size() / 2);
  EXPECT_EQ((result = fit_light(of({grey_picture(200, 7), small}), *map, report)).code(), ErrorCode::kInconsistent);
}

TEST(LightFit, UsesOnlyTheRegionOfInterest) {
  hal::Picture picture = grey_picture(200, 8);
  // A white window beside the field.
  for (std::uint32_t v = 0; v < kPictureHeight; ++v) {
    for (std::uint32_t i = 0; i < 3 * 80; ++i) picture.rgb8[3 * v * kPictureWidth + i] = 255;
  }
  Polygon region;
  for (const PixelPoint p : {PixelPoint{80, 0}, {319, 0}, {319, 239}, {80, 239}}) region.push_back(p);
  auto map = std::make_unique<LightMap>();
  LightReport report;
  ASSERT_EQ(fit_light(of({picture}, region), *map, report).text(), "");
  EXPECT_EQ(report.saturated_cells, 0U);
  EXPECT_NEAR(static_cast<double>(cell(*map, 0, 20, 120)), static_cast<double>(cell(*map, 0, 84, 120)), 0.05);
}

TEST(LightFit, MapIsReadBackFromItsFile) {
  auto map = std::make_unique<LightMap>(), back = std::make_unique<LightMap>();
  LightReport report;
  ASSERT_EQ(fit_light(of({grey_picture(200, 9)}), *map, report).text(), "");
  const std::string path = ::testing::TempDir() + "/touchline_light_map.png";
  ASSERT_OK(hal::write_picture(path, map_picture(*map)));
  ASSERT_OK(config::read_light_map(path, *back));
  ASSERT_EQ(back->columns, map->columns);
  ASSERT_EQ(back->rows, map->rows);
  for (std::size_t i = 0; i < 64 * 48; ++i) {
    ASSERT_NEAR(static_cast<double>(back->illumination[1][i]), static_cast<double>(map->illumination[1][i]), 2e-5);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace touchline::calibrate
