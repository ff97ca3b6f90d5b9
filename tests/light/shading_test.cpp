#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "core/light/shading.h"

namespace touchline::testing {
namespace {

LightMap uniform(float r, float g, float b, std::uint16_t columns = 4, std::uint16_t rows = 3) {
  LightMap map;
  map.columns = columns;
  map.rows = rows;
  map.illumination[0].fill(r);
  map.illumination[1].fill(g);
  map.illumination[2].fill(b);
  return map;
}

double ideal_level(double gain) { return 64.0 + 32.0 * std::log2(gain); }

TEST(Gain, GrowsByThe32ndRootOfTwoPerLevel) {
  EXPECT_EQ(gain_of_level(0), 0.25f);
  EXPECT_EQ(gain_of_level(32), 0.5f);
  EXPECT_EQ(gain_of_level(kNeutralLevel), 1.0f);
  EXPECT_EQ(gain_of_level(96), 2.0f);
  for (std::uint8_t level = 0; level < kLightLevels; ++level) {
    EXPECT_EQ(gain_of_level(level), static_cast<float>(std::exp2((level - 64) / 32.0))) << int{level};
  }
}

TEST(LevelOfGain, IsTheNearestByRatio) {
  for (std::uint8_t level = 0; level < kLightLevels; ++level) {
    EXPECT_EQ(level_of_gain(gain_of_level(level)), level);
  }
  for (double exponent = -1.99; exponent < 1.96; exponent += 0.00173) {
    const double gain = std::exp2(exponent);
    EXPECT_NEAR(level_of_gain(static_cast<float>(gain)), ideal_level(gain), 0.5 + 1e-4) << gain;
  }
  EXPECT_EQ(level_of_gain(1e-6f), 0);
  EXPECT_EQ(level_of_gain(1e6f), kLightLevels - 1);
}

TEST(Corrected, IsUnchangedAtTheNeutralLevel) {
  for (int value = 0; value < 256; ++value) {
    const auto v = static_cast<std::uint8_t>(value);
    EXPECT_EQ(corrected(v, kNeutralLevel, 0), v);
    EXPECT_EQ(corrected(v, kNeutralLevel, 16), v);
    EXPECT_EQ(corrected(v, kNeutralLevel, 128), v);
  }
}

TEST(Corrected, ScalesAboutBlack) {
  EXPECT_EQ(corrected(100, 96, 0), 200);
  EXPECT_EQ(corrected(101, 32, 0), 51) << "50.5 is rounded up";
  EXPECT_EQ(corrected(200, 96, 0), 255);
  EXPECT_EQ(corrected(16, 96, 16), 16) << "black stays black";
  EXPECT_EQ(corrected(66, 96, 16), 116);
  EXPECT_EQ(corrected(10, 96, 16), 4);
  EXPECT_EQ(corrected(128, 96, 128), 128);
  EXPECT_EQ(corrected(138, 96, 128), 148);
  EXPECT_EQ(corrected(118, 96, 128), 108);
  EXPECT_EQ(corrected(20, 96, 128), 0) << "clamped to 0";
  EXPECT_EQ(corrected(250, 96, 128), 255) << "clamped to 255";
}

TEST(Corrected, NeverDecreasesWithTheValue) {
  for (const std::uint8_t black : std::initializer_list<std::uint8_t>{0, 16, 128}) {
    for (std::uint8_t level = 0; level < kLightLevels; ++level) {
      for (int value = 1; value < 256; ++value) {
        ASSERT_GE(corrected(static_cast<std::uint8_t>(value), level, black),
                  corrected(static_cast<std::uint8_t>(value - 1), level, black));
      }
    }
  }
}

class ShadingTest : public ::testing::Test {
 protected:
  std::unique_ptr<Shading> shading_ = std::make_unique<Shading>();
};

TEST_F(ShadingTest, IsInactiveWithoutAMap) {
  EXPECT_TRUE(shading_->build(uniform(1, 1, 1), 640, 480, ColorSpace::kRgb).ok());
  EXPECT_TRUE(shading_->active());
  EXPECT_TRUE(shading_->build(LightMap{}, 640, 480, ColorSpace::kRgb).ok());
  EXPECT_FALSE(shading_->active());
}

TEST_F(ShadingTest, EachChannelHasTheInverseOfItsIllumination) {
  ASSERT_TRUE(shading_->build(uniform(0.5f, 1.0f, 2.0f), 100, 50, ColorSpace::kRgb).ok());
  for (std::uint16_t row = 0; row < 7; ++row) {
    for (std::uint16_t column = 0; column < 7; ++column) {
      EXPECT_EQ(shading_->level(0, column, row), 96);
      EXPECT_EQ(shading_->level(1, column, row), kNeutralLevel);
      EXPECT_EQ(shading_->level(2, column, row), 32);
    }
  }
}

TEST_F(ShadingTest, YuvUsesTheLuminanceForAllChannels) {
  ASSERT_TRUE(shading_->build(uniform(0.3f, 0.9f, 1.7f), 100, 50, ColorSpace::kYuv).ok());
  const double luminance = 0.299 * 0.3 + 0.587 * 0.9 + 0.114 * 1.7;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    EXPECT_EQ(shading_->level(channel, 3, 3), std::lround(ideal_level(1.0 / luminance)));
  }
}

TEST_F(ShadingTest, InterpolatesBetweenCellCentersAndIsConstantBeyond) {
  // Light that is linear over the picture is reproduced exactly between the outermost cell centers.
  constexpr std::uint16_t kWidth = 647, kHeight = 483, kColumns = 9, kRows = 7;
  LightMap map = uniform(1, 1, 1, kColumns, kRows);
  const auto light = [](double u_share, double v_share) { return 0.4 + 1.1 * u_share + 0.8 * v_share; };
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      map.illumination[1][row * kColumns + column] = static_cast<float>(
          light((static_cast<double>(column) + 0.5) / kColumns, (static_cast<double>(row) + 0.5) / kRows));
    }
  }
  ASSERT_TRUE(shading_->build(map, kWidth, kHeight, ColorSpace::kRgb).ok());
  const auto bounded = [](double share, int cells) { return std::clamp(share, 0.5 / cells, 1.0 - 0.5 / cells); };
  for (std::uint16_t row = 0; row * kTileHeight < kHeight; ++row) {
    for (std::uint16_t column = 0; column * kTileWidth < kWidth; ++column) {
      const double u_share = bounded((column + 0.5) * kTileWidth / kWidth, kColumns);
      const double v_share = bounded((row + 0.5) * kTileHeight / kHeight, kRows);
      ASSERT_NEAR(shading_->level(1, column, row), ideal_level(1.0 / light(u_share, v_share)), 0.5 + 1e-3)
          << column << ", " << row;
      ASSERT_EQ(shading_->level(0, column, row), kNeutralLevel);
    }
  }
}

TEST_F(ShadingTest, RejectsInvalidMaps) {
  const auto code_of = [&](const LightMap& map, std::uint16_t width = 64, std::uint16_t height = 64) {
    EXPECT_TRUE(shading_->build(uniform(1, 1, 1), 64, 64, ColorSpace::kRgb).ok());
    const ErrorCode code = shading_->build(map, width, height, ColorSpace::kRgb).code();
    EXPECT_FALSE(shading_->active()) << "inactive after an error";
    return code;
  };
  for (const float bad :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    LightMap map = uniform(1, 1, 1);
    map.illumination[2][11] = bad;
    EXPECT_EQ(code_of(map), ErrorCode::kOutOfRange) << bad;
  }
  EXPECT_EQ(code_of(uniform(1, 1, 1, 65, 48)), ErrorCode::kOutOfRange) << "more cells than the capacity";
  EXPECT_EQ(code_of(uniform(1, 1, 1, 4, 0)), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of(uniform(1, 1, 1), 0), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of(uniform(1, 1, 1), kMaxFrameWidth + 1), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of(uniform(1, 1, 1), 64, kMaxFrameHeight + 1), ErrorCode::kOutOfRange);
}

}  // namespace
}  // namespace touchline::testing
