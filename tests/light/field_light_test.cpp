// Tests the change of light that FieldLight measures on drawn fields with texture, noise, robots and shadows.
#include "core/light/field_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr int kPictureWidth = 640, kPictureHeight = 480;
// Tolerance: a sixth of a box's usual width, or 4.4 %.
constexpr float kAccuracy_levels = 2.0f;

using Factors = std::array<double, 3>;

// A grey floor with stains and white lines, and robots on it. Only the pixels that FieldLight reads are drawn.
class FieldLightTest : public ::testing::Test {
 protected:
  struct Robot {
    int u = 0, v = 0;
  };
  using Light = std::function<Factors(int, int)>;

  static Light uniform(double r, double g, double b) {
    return [=](int, int) { return Factors{r, g, b}; };
  }
  // Dark on the left half.
  static Factors shadow(int u, int) { return u < kPictureWidth / 2 ? Factors{0.35, 0.35, 0.35} : Factors{1, 1, 1}; }

  Frame show(const Light& light, const std::vector<Robot>& robots = {}) {
    std::normal_distribution<double> noise(0.0, 1.5);
    for (int v = 4; v < kPictureHeight; v += 8) {
      for (int u = 4; u < kPictureWidth; u += 8) {
        const bool line = u % 160 < 8 || v % 120 < 8;
        Factors value = line ? Factors{150, 150, 150} : Factors{58.0 + (u / 3 + v / 5) % 7, 61, 59};
        for (const Robot& robot : robots) {
          const int du = u - robot.u, dv = v - robot.v;
          if (std::max(std::abs(du), std::abs(dv)) > 15) continue;
          value = {12, 12, 12};
          if (du < -2 && dv < -2) value = {30, 60, 190};
          if (du > 2 && dv > 2) value = {190, 30, 40};
        }
        const Factors factor = light(u, v);
        Channels rgb{};
        for (std::size_t c = 0; c < 3; ++c) {
          rgb[c] = static_cast<std::uint8_t>(std::clamp(std::lround(value[c] * factor[c] + noise(random_)), 0L, 255L));
        }
        picture_->set(u, v, rgb);
      }
    }
    return picture_->frame();
  }

  void start(const std::vector<Robot>& robots = {}) {
    const Frame frame = show(uniform(1, 1, 1), robots);
    const ReferenceGrid grid = ReferenceGrid::of(kPictureWidth, kPictureHeight);
    reference_->columns = grid.columns;
    reference_->rows = grid.rows;
    for (std::size_t row = 0; row < grid.rows; ++row) sample_cells(frame, grid, row, reference_->colors);
    ASSERT_TRUE(field_->configure(*reference_, frame.format, kPictureWidth, kPictureHeight).ok());
  }

  // Returns the largest deviation from the true change, away from the borders of shadows.
  float error(const Light& light, int skip_from_u = 0, int skip_to_u = 0) {
    float most = 0;
    for (std::uint16_t row = 0; row < kPictureHeight / kTileHeight; ++row) {
      for (std::uint16_t column = 0; column < kPictureWidth / kTileWidth; ++column) {
        const int u = column * kTileWidth + kTileWidth / 2, v = row * kTileHeight + kTileHeight / 2;
        if (u >= skip_from_u && u < skip_to_u) continue;
        const Factors factor = light(u, v);
        for (std::size_t c = 0; c < 3; ++c) {
          const auto truth = static_cast<float>(32.0 * std::log2(factor[c]));
          most = std::max(most, std::abs(field_->at(c, column, row) - truth));
        }
      }
    }
    return most;
  }

  std::mt19937 random_{7};
  std::unique_ptr<OwnedPicture> picture_ =
      std::make_unique<OwnedPicture>(PixelFormat::kRgb24, kPictureWidth, kPictureHeight, 0);
  std::unique_ptr<LightReference> reference_ = std::make_unique<LightReference>();
  std::unique_ptr<FieldLight> field_ = std::make_unique<FieldLight>();
};

const std::vector<std::array<int, 2>> kRobotPlaces = {{60, 60},   {90, 80},   {300, 200},
                                                      {335, 210}, {310, 240}, {600, 440}};

TEST_F(FieldLightTest, AStepIsKnownInItsFirstFrame) {
  for (const double factor : {0.35, 0.5, 0.75, 0.9, 1.25, 1.5, 1.65}) {
    start();
    for (int i = 0; i < 10; ++i) ASSERT_FALSE(field_->measure(show(uniform(1, 1, 1))));
    const Light light = uniform(factor, factor, factor);
    EXPECT_TRUE(field_->measure(show(light))) << factor;
    EXPECT_LT(error(light), kAccuracy_levels) << factor;
    EXPECT_NEAR(std::exp2(field_->mean() / kLevelsPerOctave), factor, 0.03 * factor);
    for (std::uint16_t row = 0; row < kPictureHeight / kTileHeight; ++row) EXPECT_TRUE(field_->changed(row));
    // Then the light changes back.
    field_->measure(show(uniform(1, 1, 1)));
    EXPECT_LT(error(uniform(1, 1, 1)), kAccuracy_levels) << factor;
  }
}

TEST_F(FieldLightTest, SaturatedLinesDoNotHideTwiceTheLight) {
  start();
  field_->measure(show(uniform(1, 1, 1)));
  field_->measure(show(uniform(2, 2, 2)));
  EXPECT_LT(error(uniform(2, 2, 2)), kAccuracy_levels);
}

TEST_F(FieldLightTest, AChangeOfTintIsMeasuredPerChannel) {
  start();
  field_->measure(show(uniform(1, 1, 1)));
  const Light light = uniform(1.15, 1, 0.85);
  EXPECT_TRUE(field_->measure(show(light)));
  EXPECT_LT(error(light), kAccuracy_levels);
  EXPECT_NEAR(field_->channel_means()[0], 6.5f, kAccuracy_levels);
  EXPECT_NEAR(field_->channel_means()[1], 0.0f, kAccuracy_levels);
  EXPECT_NEAR(field_->channel_means()[2], -7.5f, kAccuracy_levels);
  field_->reset();
  EXPECT_EQ(field_->channel_means()[0], 0.0f);
}

TEST_F(FieldLightTest, AShadowHasASharpEdge) {
  start();
  field_->measure(show(uniform(1, 1, 1)));
  field_->measure(show(shadow));
  EXPECT_LT(error(shadow, 288, 352), kAccuracy_levels);
}

TEST_F(FieldLightTest, AShadowOverAQuarterIsKnownAfterEightFrames) {
  start();
  const Light quarter = [](int u, int v) { return v < kPictureHeight / 2 ? shadow(u, v) : Factors{1, 1, 1}; };
  field_->measure(show(uniform(1, 1, 1)));
  for (int i = 0; i < 8; ++i) field_->measure(show(quarter));
  float most = 0;
  for (const auto& [u, v, truth] : {std::tuple{100, 100, -48.5f}, {100, 400, 0.0f}, {500, 100, 0.0f}}) {
    most = std::max(most, std::abs(field_->at(0, static_cast<std::uint16_t>(u / kTileWidth),
                                              static_cast<std::uint16_t>(v / kTileHeight)) -
                                   truth));
  }
  EXPECT_LT(most, kAccuracy_levels);
}

TEST_F(FieldLightTest, RobotsThatComeGoAndCrowdAreNoChangeOfLight) {
  std::vector<Robot> robots;
  for (const auto& [u, v] : kRobotPlaces) robots.push_back({u, v});
  start(robots);  // the reference contains robots that drive away
  for (int i = 0; i < 20; ++i) {
    for (Robot& robot : robots) robot.u = (robot.u + 13) % kPictureWidth;
    ASSERT_FALSE(field_->measure(show(uniform(1, 1, 1), robots))) << i;
  }
  field_->measure(show(uniform(0.5, 0.5, 0.5), robots));
  EXPECT_LT(error(uniform(0.5, 0.5, 0.5)), kAccuracy_levels) << "also below the robots";
}

// Rows in which nothing fits look as after a step of the light, but measuring all rows again does not change the
// result.
TEST_F(FieldLightTest, WhatNeverFitsIsNoStepAndHidesNone) {
  start();
  constexpr int kCell_px = 16, kRowsOfAFrame = 8;
  double light = 1;
  const auto is_covered = [](int v) { return v / kCell_px % kRowsOfAFrame == 3; };
  const Light things = [&](int u, int v) {
    constexpr std::array kThings{0.4, 1.7, 0.6, 2.2};
    const double factor = is_covered(v) ? light * kThings[static_cast<std::size_t>(u / kCell_px) % 4] : light;
    return Factors{factor, factor, factor};
  };
  const Light with_shadow = [&](int u, int v) {
    const bool is_dark = u < kPictureWidth / 4 && v < kPictureHeight / 2 && !is_covered(v);
    const Factors factor = things(u, v);
    return is_dark ? Factors{0.5 * factor[0], 0.5 * factor[1], 0.5 * factor[2]} : factor;
  };
  for (int i = 0; i < 2 * kRowsOfAFrame; ++i) field_->measure(show(things));
  for (int i = 0; i < 2 * kRowsOfAFrame; ++i) {
    field_->measure(show(with_shadow));
    int changed = 0;
    for (std::uint16_t row = 0; row < kPictureHeight / kTileHeight; row += 2) changed += field_->changed(row) ? 1 : 0;
    EXPECT_LE(changed, 4) << "only the rows of this frame, " << i;
  }
  light = 0.6;
  field_->measure(show(things));
  EXPECT_LT(error(uniform(light, light, light)), kAccuracy_levels) << "all rows at once";
}

// In some rows, most cells fit but are brighter than the light around them.
TEST_F(FieldLightTest, AConstantDeviationIsNoStep) {
  start();
  constexpr int kCell_px = 16, kRowsOfAFrame = 8;
  const Light things = [&](int u, int v) {
    const bool is_brighter = v / kCell_px % kRowsOfAFrame == 3 && u / kCell_px % 4 != 0;
    const double factor = is_brighter ? 1.12 : 1.0;
    return Factors{factor, factor, factor};
  };
  for (int i = 0; i < 2 * kRowsOfAFrame; ++i) field_->measure(show(things));
  const Light with_shadow = [&](int u, int v) {
    const double factor = (u < kPictureWidth / 4 && v < kPictureHeight / 2 ? 0.5 : 1.0) * things(u, v)[0];
    return Factors{factor, factor, factor};
  };
  for (int i = 0; i < 2 * kRowsOfAFrame; ++i) {
    field_->measure(show(with_shadow));
    int changed = 0;
    for (std::uint16_t row = 0; row < kPictureHeight / kTileHeight; row += 2) changed += field_->changed(row) ? 1 : 0;
    EXPECT_LE(changed, 4) << "only the rows of this frame, " << i;
  }
}

TEST_F(FieldLightTest, UnusablePartsAreInterpolated) {
  start();
  for (auto& sums : reference_->colors.sum) {
    for (std::size_t cell = 0; cell < std::size_t{40} * 30; ++cell) {
      if (cell % 40 >= 10 && cell % 40 < 30) sums[cell] = 0;
    }
  }
  ASSERT_TRUE(field_->configure(*reference_, PixelFormat::kRgb24, kPictureWidth, kPictureHeight).ok());
  const Light gradient = [](int u, int) {
    const double factor = 0.5 + 0.5 * u / kPictureWidth;
    return Factors{factor, factor, factor};
  };
  field_->measure(show(gradient));
  EXPECT_LT(error(gradient), 4 * kAccuracy_levels);
  EXPECT_LT(field_->at(0, 12, 30), field_->at(0, 27, 30));
}

TEST_F(FieldLightTest, APersonAboveTheFieldIsNoShadow) {
  start();
  field_->measure(show(uniform(1, 1, 1)));
  const Light person = [](int u, int) { return u < 2 * kPictureWidth / 5 ? Factors{1.9, 1.2, 0.6} : Factors{1, 1, 1}; };
  for (int i = 0; i < 20; ++i) field_->measure(show(person));
  EXPECT_LT(error(uniform(1, 1, 1), 0, 320), kAccuracy_levels) << "of what is seen";
}

TEST_F(FieldLightTest, ResetForgetsAndOffMeasuresNothing) {
  start();
  field_->measure(show(uniform(0.5, 0.5, 0.5)));
  field_->reset();
  EXPECT_EQ(field_->mean(), 0.0f);
  EXPECT_EQ(field_->at(0, 20, 30), 0.0f);
  ASSERT_TRUE(field_->configure({}, PixelFormat::kRgb24, kPictureWidth, kPictureHeight).ok());
  EXPECT_FALSE(field_->active());
  EXPECT_FALSE(field_->measure(show(uniform(0.5, 0.5, 0.5))));
  EXPECT_EQ(field_->at(0, 20, 30), 0.0f);
  EXPECT_EQ(field_->configure(*reference_, PixelFormat::kRgb24, kPictureWidth / 2, kPictureHeight).code(),
            ErrorCode::kInconsistent);
  EXPECT_EQ(field_->configure(*reference_, PixelFormat::kRgb24, 0, kPictureHeight).code(), ErrorCode::kOutOfRange);
}

TEST_F(FieldLightTest, InYuvAllChannelsHaveTheChangeOfLuma) {
  for (const PixelFormat format : kAllFormats) {
    const ColorSpace space = color_space(format);
    if (!is_yuv(space)) continue;
    OwnedPicture picture(format, kPictureWidth, kPictureHeight, 5);
    const auto fill = [&](double factor) {
      for (int v = 0; v < kPictureHeight; ++v) {
        for (int u = 0; u < kPictureWidth; ++u) {
          const auto scaled = [&](double black, double value) {
            return static_cast<std::uint8_t>(std::lround(black + (value - black) * factor));
          };
          picture.set(u, v, {scaled(black_value(space, 0), 90 + u % 5), scaled(128, 120), scaled(128, 133)});
        }
      }
    };
    fill(1.0);
    const ReferenceGrid grid = ReferenceGrid::of(kPictureWidth, kPictureHeight);
    reference_->columns = grid.columns;
    reference_->rows = grid.rows;
    for (std::size_t row = 0; row < grid.rows; ++row) sample_cells(picture.frame(), grid, row, reference_->colors);
    ASSERT_TRUE(field_->configure(*reference_, format, kPictureWidth, kPictureHeight).ok());
    fill(0.5);
    EXPECT_TRUE(field_->measure(picture.frame())) << name_of(format);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(field_->at(c, 7, 30), -32.0f, 1.5f) << name_of(format);
  }
}

TEST(ReferenceGridTest, HasWholeTilesAndFitsForEverySize) {
  for (const auto& [width, height] : {std::array<int, 2>{1, 1},
                                      {16, 16},
                                      {17, 9},
                                      {640, 480},
                                      {632, 468},
                                      {1280, 720},
                                      {1920, 1080},
                                      {2592, 1944},
                                      {2592, 16},
                                      {3, 1944}}) {
    const ReferenceGrid grid = ReferenceGrid::of(static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height));
    EXPECT_LE(grid.cells(), kMaxReferenceCells);
    EXPECT_LE(grid.rows, kMaxReferenceRows);
    EXPECT_GE(grid.columns * grid.side_px, width);
    EXPECT_GE(grid.rows * grid.side_px, height);
    EXPECT_EQ(grid.side_px % kTileWidth, 0);
    const auto last_column = static_cast<std::uint16_t>((width - 1) / kTileWidth);
    const auto last_row = static_cast<std::uint16_t>((height - 1) / kTileHeight);
    EXPECT_LT(grid.cell_of_tile(last_column, last_row), grid.cells());
    // Reads no byte outside of the picture, which a sanitizer detects.
    for (const PixelFormat format : kAllFormats) {
      if (width * height > 100000) break;
      const OwnedPicture picture(format, width, height, 3);
      CellColors colors;
      for (std::size_t row = 0; row < grid.rows; ++row) sample_cells(picture.frame(), grid, row, colors);
    }
  }
  EXPECT_EQ(ReferenceGrid::of(640, 480).columns, 40);
}

}  // namespace
}  // namespace touchline::testing
