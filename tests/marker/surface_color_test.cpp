#include "core/marker/surface_color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr int kPictureWidth = 160, kPictureHeight = 120;
constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

// Red on dark grey, or the same in YUV.
Channels surface_value(ColorSpace space, bool red) {
  if (space == ColorSpace::kRgb) return red ? Channels{160, 50, 40} : Channels{40, 40, 40};
  return red ? Channels{90, 104, 182} : Channels{50, 128, 128};
}

// A rectangle of 40 x 12 pixels about the middle, rotated.
OwnedPicture rectangle(PixelFormat format, float angle_rad, float u, float v) {
  OwnedPicture picture(format, kPictureWidth, kPictureHeight, 3);
  for (int row = 0; row < kPictureHeight; ++row) {
    for (int column = 0; column < kPictureWidth; ++column) {
      const float du = static_cast<float>(column) - u, dv = static_cast<float>(row) - v;
      const float along = std::cos(angle_rad) * du + std::sin(angle_rad) * dv;
      const float across = std::cos(angle_rad) * dv - std::sin(angle_rad) * du;
      picture.set(column, row,
                  surface_value(color_space(format), std::abs(along) <= 20.0f && std::abs(across) <= 6.0f));
    }
  }
  return picture;
}

TEST(GrownPatch, HasPlaceAreaAndAxisOfTheWholePatch) {
  for (const PixelFormat format : kAllFormats) {
    for (const float angle : {0.0f, 0.4f, 1.3f, -0.7f}) {
      const OwnedPicture picture = rectangle(format, angle, 80.3f, 60.8f);
      // From a point near one end.
      const PixelPoint seed{80.3f + 9.0f * std::cos(angle), 60.8f + 9.0f * std::sin(angle)};
      GrownPatch patch;
      ASSERT_TRUE(grow_patch(picture.frame(), seed, 34.0f, patch)) << name_of(format);
      EXPECT_NEAR(patch.center.u_px, 80.3f, 1.2f) << name_of(format);
      EXPECT_NEAR(patch.center.v_px, 60.8f, 1.2f) << name_of(format);
      EXPECT_NEAR(patch.area_px, 480.0f, 70.0f) << name_of(format);
      EXPECT_NEAR(std::remainder(patch.axis_rad - angle, 3.14159265f), 0.0f, 0.05f) << name_of(format);
      EXPECT_NEAR(patch.major_px2, 40.0f * 40.0f / 12.0f, 25.0f);
      EXPECT_NEAR(patch.minor_px2, 12.0f * 12.0f / 12.0f, 4.0f);
    }
  }
}

// Every pixel, and every second one.
TEST(GrownPatch, HasTheSidesOfASquare) {
  for (const float half : {6.0f, 20.0f}) {
    for (const float angle : {0.0f, 0.3f, 0.785f, -0.6f}) {
      OwnedPicture square(PixelFormat::kRgb24, kPictureWidth, kPictureHeight, 3);
      OwnedPicture disk(PixelFormat::kRgb24, kPictureWidth, kPictureHeight, 3);
      for (int row = 0; row < kPictureHeight; ++row) {
        for (int column = 0; column < kPictureWidth; ++column) {
          const float du = static_cast<float>(column) - 80.3f, dv = static_cast<float>(row) - 60.8f;
          const float along = std::abs(std::cos(angle) * du + std::sin(angle) * dv);
          const float across = std::abs(std::cos(angle) * dv - std::sin(angle) * du);
          square.set(column, row, surface_value(ColorSpace::kRgb, std::max(along, across) <= half));
          disk.set(column, row, surface_value(ColorSpace::kRgb, std::hypot(along, across) <= half));
        }
      }
      GrownPatch patch;
      ASSERT_TRUE(grow_patch(square.frame(), {82.0f, 59.0f}, 1.6f * half, patch));
      EXPECT_NEAR(std::remainder(patch.side_rad - angle, 0.5f * 3.14159265f), 0.0f, 0.06f) << half << ", " << angle;
      EXPECT_NEAR(patch.squareness, 1.0f, 0.15f) << half << ", " << angle;
      ASSERT_TRUE(grow_patch(disk.frame(), {82.0f, 59.0f}, 1.6f * half, patch));
      EXPECT_LT(patch.squareness, 0.2f) << half;
    }
  }
}

TEST(GrownPatch, EndsWhereAnotherPatchOfTheColorIsSeparate) {
  OwnedPicture picture = rectangle(PixelFormat::kRgb24, 0.0f, 80.0f, 50.0f);
  for (int column = 60; column <= 100; ++column) {
    for (int row = 58; row <= 70; ++row) picture.set(column, row, surface_value(ColorSpace::kRgb, true));
  }
  GrownPatch patch;
  ASSERT_TRUE(grow_patch(picture.frame(), {80.0f, 50.0f}, 22.0f, patch));
  EXPECT_NEAR(patch.center.v_px, 50.0f, 0.6f);
}

// Every pixel, or every second one, of a window that goes an eighth beyond one of the picture's edges.
TEST(GrownPatch, IsWholeAtTheEdgesOfThePicture) {
  for (const float reach : {16.0f, 40.0f}) {
    const auto half = static_cast<int>(0.75f * reach);
    for (const int from_edge : {half, half + 1}) {
      for (const auto& [u, v] : {std::pair{from_edge, kPictureHeight / 2},
                                 {kPictureWidth - 1 - from_edge, kPictureHeight / 2},
                                 {kPictureWidth / 2, from_edge},
                                 {kPictureWidth / 2, kPictureHeight - 1 - from_edge}}) {
        OwnedPicture picture(PixelFormat::kRgb24, kPictureWidth, kPictureHeight, 3);
        for (int row = 0; row < kPictureHeight; ++row) {
          for (int column = 0; column < kPictureWidth; ++column) {
            const bool red = std::abs(column - u) <= half && std::abs(row - v) <= half;
            picture.set(column, row, surface_value(ColorSpace::kRgb, red));
          }
        }
        GrownPatch patch;
        const PixelPoint seed{static_cast<float>(u), static_cast<float>(v)};
        ASSERT_TRUE(grow_patch(picture.frame(), seed, reach, patch)) << u << ", " << v;
        const auto side = static_cast<float>(2 * half + 1);
        EXPECT_NEAR(patch.area_px, side * side, reach > 23.0f ? 2.5f * side : 0.0f) << u << ", " << v;
        EXPECT_NEAR(patch.center.u_px, seed.u_px, 1.0f) << u << ", " << v;
        EXPECT_NEAR(patch.center.v_px, seed.v_px, 1.0f) << u << ", " << v;
      }
    }
  }
}

TEST(GrownPatch, NeedsAPointInThePictureAndSomePixels) {
  const OwnedPicture picture = rectangle(PixelFormat::kYuyv, 0.0f, 80.0f, 60.0f);
  GrownPatch patch;
  for (const PixelPoint& seed : {PixelPoint{-1.0f, 60.0f}, PixelPoint{80.0f, 1e9f}, PixelPoint{kNoNumber, 60.0f}}) {
    EXPECT_FALSE(grow_patch(picture.frame(), seed, 20.0f, patch));
  }
  // Half of the window is outside.
  EXPECT_FALSE(grow_patch(picture.frame(), {3.0f, 3.0f}, 20.0f, patch));
  // A window of 3 x 3 pixels has exactly nine.
  EXPECT_TRUE(grow_patch(picture.frame(), {80.0f, 60.0f}, 1.0f, patch));
}

TEST(Surface, IsTheMeanWithoutTheOutliers) {
  OwnedPicture picture(PixelFormat::kRgb24, 20, 20, 0);
  for (int v = 0; v < 20; ++v) {
    for (int u = 0; u < 20; ++u) picture.set(u, v, {100, 50, 20});
  }
  picture.set(9, 9, {255, 255, 255});
  picture.set(10, 11, {0, 0, 0});
  SurfaceColor surface;
  ASSERT_TRUE(sample_surface(picture.frame(), {10.0f, 10.0f}, 1, surface));
  EXPECT_EQ(surface.rgb, (std::array<float, 3>{100, 50, 20}));
  EXPECT_GT(surface.spread[0], 30.0f);
  // A lamp's reflection in one pixel does not change the mean.
  EXPECT_FALSE(surface.saturated[0]);
  ASSERT_TRUE(sample_surface(picture.frame(), {10.0f, 10.0f}, 3, surface));
  EXPECT_EQ(surface.spread[0], 0.0f);
  for (int u = 8; u < 13; ++u) {
    for (int v = 8; v < 13; ++v) picture.set(u, v, {254, 50, 20});
  }
  ASSERT_TRUE(sample_surface(picture.frame(), {10.0f, 10.0f}, 1, surface));
  EXPECT_EQ(surface.saturated, (std::array<bool, 3>{true, false, false}));
  EXPECT_FALSE(sample_surface(picture.frame(), {18.0f, 10.0f}, 2, surface));
  EXPECT_FALSE(sample_surface(picture.frame(), {10.0f, kNoNumber}, 1, surface));
}

}  // namespace
}  // namespace touchline::testing
