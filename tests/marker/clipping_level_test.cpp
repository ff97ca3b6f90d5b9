#include "core/marker/clipping_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/marker/surface_color.h"
#include "tests/color/owned_picture.h"
#include "tests/marker/portable_random.h"

namespace touchline::testing {
namespace {

constexpr int kFieldColumns = 320, kFieldRows = 240;

// A dark floor with a white line and a patch, darkened by `gain` after the camera clipped the values at 255.
OwnedPicture darkened(const std::array<int, 3>& patch, float gain, int noise = 3,
                      PixelFormat format = PixelFormat::kRgb24) {
  OwnedPicture picture(format, kFieldColumns, kFieldRows, 0);
  PortableRandom random{5};
  for (int v = 0; v < kFieldRows; ++v) {
    for (int u = 0; u < kFieldColumns; ++u) {
      const bool on_line = u > 280 && u<300, on_patch = u> 100 && u < 140 && v > 100 && v < 140;
      Channels value{};
      for (std::size_t c = 0; c < 3; ++c) {
        const int surface = on_line ? 225 : on_patch ? patch[c] : 60;
        const int clipped = std::min(255, surface + random.whole(-noise, noise));
        value[c] = static_cast<std::uint8_t>(std::lround(gain * static_cast<float>(clipped)));
      }
      picture.set(u, v, value);
    }
  }
  return picture;
}

TEST(ClippingLevel, IsBelow255InADarkenedPicture) {
  for (const PixelFormat format : {PixelFormat::kRgb24, PixelFormat::kBgr24, PixelFormat::kXrgb8888}) {
    const OwnedPicture picture = darkened({270, 180, 200}, 0.7f, 3, format);
    const int level = saturated_from(picture.frame());
    EXPECT_GE(level, 172);
    EXPECT_LE(level, 178);  // 0.7 * 255 = 178.5
  }
}

TEST(ClippingLevel, IsThatOf255AsSoonAsAPixelHasIt) {
  EXPECT_EQ(saturated_from(darkened({270, 180, 200}, 1.0f).frame()), kSaturatedValue);
  OwnedPicture picture = darkened({270, 180, 200}, 0.7f);
  picture.set(16, 16, {20, 20, 251});
  EXPECT_EQ(saturated_from(picture.frame()), kSaturatedValue);
}

// The brightest surface is not clipped: its noise is seen on both sides of its value.
TEST(ClippingLevel, IsNotTheValueOfABrightPatch) {
  EXPECT_EQ(saturated_from(darkened({240, 180, 200}, 0.7f).frame()), kSaturatedValue);
  EXPECT_EQ(saturated_from(darkened({240, 180, 200}, 0.5f, 8).frame()), kSaturatedValue);
}

TEST(ClippingLevel, IsNotThatOfWhiteWithoutNoise) {
  EXPECT_EQ(saturated_from(darkened({200, 180, 60}, 0.7f, 0).frame()), kSaturatedValue);
}

TEST(ClippingLevel, IsNotLookedForInYuv) {
  EXPECT_EQ(saturated_from(darkened({270, 180, 200}, 0.7f, 3, PixelFormat::kYuyv).frame()), kSaturatedValue);
}

}  // namespace
}  // namespace touchline::testing
