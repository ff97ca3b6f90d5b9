#include <gtest/gtest.h>

#include <limits>

#include "core/light/light_change.h"
#include "core/light/shading.h"

namespace touchline::testing {
namespace {

constexpr std::array<float, 3> kAll = {1, 1, 1};

LightChange change_of(float max_levels = 32) {
  LightChange change;
  EXPECT_TRUE(change.configure(640, 480, max_levels).ok());
  return change;
}

TEST(LightChange, RejectsInvalidSizesAndLimits) {
  LightChange change;
  EXPECT_EQ(change.configure(1, 480, 10).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(change.configure(640, 1, 10).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(change.configure(640, 480, 0).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(change.configure(640, 480, std::numeric_limits<float>::quiet_NaN()).code(), ErrorCode::kOutOfRange);
}

TEST(LightChange, AnObservationMovesItsPlaceByTheStepTimesTheDifference) {
  LightChange change = change_of();
  const PixelPoint places[] = {{0, 0}, {639, 479}, {320, 240}, {80, 80}, {250.5f, 410.25f}};
  for (const PixelPoint& place : places) {
    change.reset();
    change.observe(place, {6, -4, 2}, {1, 0.5f, 0}, 0.25f);
    EXPECT_NEAR(change.at(0, place), 1.5f, 1e-5f);
    EXPECT_NEAR(change.at(1, place), -0.5f, 1e-5f);
    EXPECT_EQ(change.at(2, place), 0.0f);
  }
}

TEST(LightChange, OneObservationHasLimitedInfluence) {
  LightChange change = change_of();
  change.observe({100, 100}, {1000, -1000, 1000}, kAll, 0.1f);
  EXPECT_NEAR(change.at(0, {100, 100}), 0.1f * LightChange::kMaxStep_levels, 1e-5f);
  EXPECT_NEAR(change.at(1, {100, 100}), -0.1f * LightChange::kMaxStep_levels, 1e-5f);
}

TEST(LightChange, StaysWithinTheLimit) {
  LightChange change = change_of(12);
  for (int i = 0; i < 2000; ++i) change.observe({300, 200}, {100, -100, 5}, kAll, 0.2f);
  EXPECT_FLOAT_EQ(change.at(0, {300, 200}), 12.0f);
  EXPECT_FLOAT_EQ(change.at(1, {300, 200}), -12.0f);
  EXPECT_NEAR(change.at(2, {300, 200}), 5.0f, 1e-3f);
}

TEST(LightChange, FindsAGradientFromScatteredObservations) {
  LightChange change = change_of();
  const auto truth = [](float u, float v) { return -6.0f + 10.0f * u / 640 + 4.0f * v / 480; };
  for (int i = 0; i < 20000; ++i) {
    const auto u = static_cast<float>(i * 37 % 640), v = static_cast<float>(i * 91 % 480);
    const float levels = truth(u, v);
    change.observe({u, v}, {levels, levels, levels}, kAll, 0.01f);
  }
  for (const PixelPoint& place : {PixelPoint{20, 30}, PixelPoint{600, 30}, PixelPoint{320, 240}, PixelPoint{50, 450}}) {
    EXPECT_NEAR(change.at(0, place), truth(place.u_px, place.v_px), 0.25f);
  }
}

TEST(LightChange, RelaxingSpreadsObservationsAndKeepsTheMean) {
  LightChange change = change_of();
  for (int i = 0; i < 100; ++i) change.observe({320, 240}, {8, 8, 8}, kAll, 0.1f);
  EXPECT_EQ(change.at(0, {0, 0}), 0.0f);
  for (int i = 0; i < 20000; ++i) {
    change.observe({320, 240}, {8, 8, 8}, kAll, 0.01f);
    change.relax(0.01f);
  }
  EXPECT_NEAR(change.at(0, {0, 0}), 8.0f, 0.2f);
  EXPECT_NEAR(change.at(2, {639, 479}), 8.0f, 0.2f);
  EXPECT_NEAR(change.mean(), 8.0f, 0.2f);
}

TEST(LightChange, ChannelsWithoutObservationsFollowTheOthersSlowly) {
  LightChange change = change_of();
  for (int i = 0; i < 40000; ++i) {
    change.observe({320, 240}, {6, 6, 0}, {1, 1, 0}, 0.01f);
    change.relax(0.01f);
  }
  EXPECT_GT(change.at(2, {320, 240}), 5.0f);
}

TEST(ShadingWithLightChange, ChangesEachTileByTheLocalChange) {
  LightMap map;
  map.columns = map.rows = 1;
  for (auto& plane : map.illumination) plane[0] = 1.0f;
  Shading shading;
  ASSERT_TRUE(shading.build(map, 640, 480, ColorSpace::kRgb).ok());
  LightChange change = change_of();
  for (int i = 0; i < 500; ++i) {
    change.observe({0, 100}, {10, 0, 0}, kAll, 0.1f);
    change.observe({639, 100}, {-10, 0, 0}, kAll, 0.1f);
  }
  for (std::uint16_t column = 0; column < shading.columns(); ++column) {
    const PixelPoint center{(static_cast<float>(column) + 0.5f) * kTileWidth, 12.5f * kTileHeight};
    EXPECT_NEAR(shading.levels(change, column, 12)[0], float{kNeutralLevel} - change.at(0, center), 0.51f);
    EXPECT_EQ(shading.levels(change, column, 12)[1], kNeutralLevel);
    EXPECT_EQ(shading.level(0, column, 12), kNeutralLevel);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(change.at(center)[c], change.at(c, center));
  }
  EXPECT_NE(shading.levels(change, 0, 12)[0], shading.levels(change, 39, 12)[0]);
}

TEST(ShadingWithLightChange, UsesLumaForAllYuvChannelsAndStaysInRange) {
  LightMap map;
  map.columns = map.rows = 1;
  for (auto& plane : map.illumination) plane[0] = 0.27f;
  Shading shading;
  ASSERT_TRUE(shading.build(map, 640, 480, ColorSpace::kYuv).ok());
  LightChange change = change_of(64);
  for (int i = 0; i < 500; ++i) change.observe({0, 0}, {-30, 5, 5}, kAll, 0.2f);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    EXPECT_EQ(shading.levels(change, 0, 0)[channel], kLightLevels - 1) << "the largest gain is 4";
    EXPECT_EQ(shading.levels(change, 39, 0)[channel], shading.level(0, 39, 0));
  }
}

}  // namespace
}  // namespace touchline::testing
