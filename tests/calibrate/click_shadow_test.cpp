#include "tools/programs/calibrate/colors/click_shadow.h"

#include <gtest/gtest.h>

#include "tests/calibrate/painted_field.h"

namespace touchline::calibrate {
namespace {

const std::vector<PaintedPatch> kPatches{{"red", {190, 40, 40}, 60, 60}, {"red", {190, 40, 40}, 240, 60}};
const std::vector<Click> kClicks{{"a.png", "red", 60, 60}, {"a.png", "red", 240, 60}};

std::vector<ShadowedClick> shadowed(PixelFormat format, double left_light) {
  // Pixel values; the left third is in shadow.
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

}  // namespace
}  // namespace touchline::calibrate
