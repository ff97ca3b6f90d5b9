#include "tools/programs/calibrate/colors/click_shadow.h"

#include <gtest/gtest.h>

#include "tests/calibrate/painted_field.h"

namespace touchline::calibrate {
namespace {

const std::vector<PaintedPatch> kPatches{{"red", {190, 40, 40}, 60, 60}, {"red", {190, 40, 40}, 240, 60}};
const std::vector<Click> kClicks{{"a.png", "red", 60, 60}, {"a.png", "red", 240, 60}};

std::vector<ShadowedClick> shadowed(PixelFormat format, double left_light) {
  // Pixel values of a picture whose left third is in shadow.
  const auto lamp = [left_light](int u, int) { return u < 106 ? std::pow(left_light, 1 / 2.2) : 1.0; };
  std::map<std::string, CameraPicture> pictures;
  pictures["a.png"] = painted_field(kPatches, format, 1, lamp);
  const auto found = clicks_in_shadow(kClicks, pictures, {}, {});
  EXPECT_TRUE(found.ok()) << found.text();
  return found.ok() ? found.value() : std::vector<ShadowedClick>{};
}

TEST(ClickInShadow, IsNamedWithTheLightOfItsPlace) {
  for (const PixelFormat format : {PixelFormat::kRgb24, PixelFormat::kYuyv}) {
    const auto found = shadowed(format, 0.3);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].number, 0U);
    EXPECT_NEAR(found[0].light, 0.3, 0.08);
    const std::string text = describe_shadow(found[0], kClicks, false);
    EXPECT_NE(text.find("red at 60,60) is in shadow"), std::string::npos) << text;
    EXPECT_NE(text.find("make a light map first"), std::string::npos) << text;
  }
}

TEST(ClickInShadow, DoesNotNameUnevenLamps) {
  EXPECT_TRUE(shadowed(PixelFormat::kRgb24, 0.7).empty());
  EXPECT_TRUE(shadowed(PixelFormat::kRgb24, 1.4).empty());
}

// A click outside the picture counts as no shadow, because the user of the clicks reports it.
TEST(ClickInShadow, DoesNotNameClicksOutsideThePictureOrTheRegionOfInterest) {
  std::map<std::string, CameraPicture> pictures;
  pictures["a.png"] = painted_field(kPatches, PixelFormat::kRgb24, 1, [](int, int) { return 1.0; });
  const std::vector<Click> outside{{"a.png", "red", 900, 60}, {"a.png", "red", 60, -200}, {"a.png", "red", 240, 60}};
  Polygon left_half;
  for (const PixelPoint corner : {PixelPoint{0, 0}, {120, 0}, {120, 240}, {0, 240}}) left_half.push_back(corner);
  const auto found = clicks_in_shadow(outside, pictures, {}, left_half);
  ASSERT_TRUE(found.ok()) << found.text();
  EXPECT_TRUE(found.value().empty());
}

}  // namespace
}  // namespace touchline::calibrate
