#include "core/region/pixel_classifier.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/region/region_scanner.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

class PixelClassifierTest : public ::testing::TestWithParam<PixelFormat> {};

// A copy gives the classes of the kernels, with light map and region of interest, for every pixel.
TEST_P(PixelClassifierTest, AgreesWithTheScannerOnEveryPixel) {
  std::mt19937 random(7);
  OwnedPicture picture(GetParam(), 75, 38, 5);
  const Frame frame = picture.frame();
  ScanParameters parameters;
  parameters.format = frame.format;
  parameters.width_px = frame.width_px;
  parameters.height_px = frame.height_px;
  parameters.boxes = random_boxes(random, 20);
  for (const PixelPoint corner : {PixelPoint{5.0f, 3.0f}, {70.0f, 6.0f}, {40.0f, 35.0f}}) {
    static_cast<void>(parameters.region_of_interest.push_back(corner));
  }
  parameters.light.columns = 3;
  parameters.light.rows = 2;
  float brightness = 0.5f;
  for (auto& plane : parameters.light.illumination) {
    for (std::size_t i = 0; i < 6; ++i) plane[i] = brightness *= 1.1f;
  }
  picture.fill([&] { return critical_value(random, parameters.boxes); });
  const auto scanner = std::make_unique<RegionScanner>();
  ASSERT_TRUE(scanner->configure(parameters).ok());
  const auto runs = std::make_unique<Runs>();
  const auto regions = std::make_unique<Regions>();
  ASSERT_TRUE(scanner->scan(frame, *runs, *regions).ok());
  std::vector<ColorId> scanned(std::size_t{frame.width_px} * frame.height_px, kBackground);
  for (const touchline::Run& run : *runs) {
    for (std::size_t u = run.begin; u < run.end; ++u) scanned[std::size_t{run.row} * frame.width_px + u] = run.color;
  }
  const auto classifier = std::make_unique<PixelClassifier>();
  scanner->copy_to(*classifier);
  EXPECT_EQ(classifier->tile_columns(), 5);
  EXPECT_EQ(classifier->tile_rows(), 5);
  std::size_t colored = 0, inside = 0;
  for (std::uint16_t v = 0; v < frame.height_px; ++v) {
    for (std::uint16_t u = 0; u < frame.width_px; ++u) {
      const bool is_inside = classifier->is_inside(u, v);
      const ColorId color = is_inside ? classifier->color_at(frame, u, v) : kBackground;
      ASSERT_EQ(color, scanned[std::size_t{v} * frame.width_px + u]) << u << ", " << v;
      colored += color != kBackground ? 1 : 0;
      inside += is_inside ? 1 : 0;
    }
  }
  EXPECT_GT(colored, 50U);
  EXPECT_GT(inside, 900U);
  EXPECT_LT(inside, 1200U);
}

TEST(PixelClassifier, WithoutALightMapAllTilesAreNeutral) {
  ScanParameters parameters;
  parameters.width_px = 64;
  parameters.height_px = 48;
  const auto scanner = std::make_unique<RegionScanner>();
  ASSERT_TRUE(scanner->configure(parameters).ok());
  const auto classifier = std::make_unique<PixelClassifier>();
  scanner->copy_to(*classifier);
  EXPECT_EQ(classifier->tile_columns(), 0);
  EXPECT_EQ(classifier->levels_of_tile(3, 2), (std::array{kNeutralLevel, kNeutralLevel, kNeutralLevel}));
  EXPECT_TRUE(classifier->is_inside(63, 47));
}

INSTANTIATE_TEST_SUITE_P(Formats, PixelClassifierTest, ::testing::ValuesIn(kAllFormats),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace touchline::testing
