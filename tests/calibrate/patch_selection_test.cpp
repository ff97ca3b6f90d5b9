#include "tools/programs/calibrate/colors/patch_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/calibrate/painted_field.h"

namespace touchline::calibrate {
namespace {

// Squares of 12 pixels around (80, 60) and (96, 60) on dark robot tops of 22 pixels.
class Rectangle : public ::testing::Test {
 protected:
  Rectangle() : inside_(image_.pixels.size(), 1) {}

  // Number of selected pixels, and how many of them are in the first square.
  std::pair<std::size_t, std::size_t> selected(const std::array<double, 4>& box) {
    Click click{"a", "red", 0, 0, 0, box};
    const Result<GrownPatch> result = select_patch(image_, inside_, click, {});
    message_ = result.text();
    if (!result.ok()) return {0, 0};
    const GrownPatch& patch = result.value();
    const auto in_square = std::count_if(patch.pixels.begin(), patch.pixels.end(), [&](std::size_t pixel) {
      const auto u = static_cast<int>(pixel % 320), v = static_cast<int>(pixel / 320);
      return u >= 74 && u < 86 && v >= 54 && v < 66;
    });
    return {patch.pixels.size(), static_cast<std::size_t>(in_square)};
  }

  const CameraPicture picture_ = painted_field({{"red", {200, 30, 30}, 80, 60}, {"green", {30, 180, 60}, 96, 60}},
                                               PixelFormat::kRgb24, 1, [](int, int) { return 1.0; });
  const ChannelImage image_ = corrected_channels(picture_.frame(), Shading{});
  std::vector<std::uint8_t> inside_;
  std::string message_;
};

TEST_F(Rectangle, SelectsThePatchIfSmallerOrLarger) {
  for (const std::array<double, 4>& box : {std::array<double, 4>{76, 56, 83, 63}, {73, 53, 86, 66}, {70, 50, 89, 70}}) {
    const auto [all, right] = selected(box);
    EXPECT_EQ(all, right) << box[0] << ": " << message_;
    EXPECT_GE(right, box[0] > 75 ? 60U : 115U) << box[0];
  }
}

TEST_F(Rectangle, IgnoresTheAreaOutsideThePicture) {
  EXPECT_EQ(selected({-20, -20, -5, -5}).first, 0U);
  EXPECT_NE(message_.find("0 pixels"), std::string::npos) << message_;
  std::fill(inside_.begin(), inside_.end(), std::uint8_t{0});
  EXPECT_EQ(selected({76, 56, 83, 63}).first, 0U);
}

}  // namespace
}  // namespace touchline::calibrate
