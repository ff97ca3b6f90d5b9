#include <gtest/gtest.h>

#include <memory>

#include "core/color/color_tables.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr Channels kNeutral = {kNeutralLevel, kNeutralLevel, kNeutralLevel};

ColorBoxes boxes_of(std::initializer_list<ColorBox> list) {
  ColorBoxes boxes;
  for (const ColorBox& box : list) boxes.push_back(box);
  return boxes;
}

class ColorTablesTest : public ::testing::Test {
 protected:
  std::unique_ptr<ColorTables> tables_ = std::make_unique<ColorTables>();
  std::mt19937 random_{7};
};

TEST_F(ColorTablesTest, EncodesThePapersYellowInTheHighestBit) {
  // Section 3.2: 200 <= R <= 220, 230 <= G <= 250, 10 <= B <= 30 as class 31.
  ColorBoxes boxes;
  for (int i = 0; i < 31; ++i) boxes.push_back({1, {0, 0, 0}, {0, 0, 0}});
  boxes.push_back({2, {200, 230, 10}, {220, 250, 30}});
  ASSERT_TRUE(tables_->build(boxes, ColorSpace::kRgb).ok());
  for (const int value : {199, 200, 220, 221}) {
    const std::uint32_t entry = tables_->table(0, kNeutralLevel)[static_cast<std::size_t>(value)];
    EXPECT_EQ(entry, value == 200 || value == 220 ? 0x80000000u : 0u) << value;
  }
  EXPECT_EQ(tables_->color_of(tables_->mask({210, 240, 20}, kNeutral)), 2);
  EXPECT_EQ(tables_->color_of(tables_->mask({210, 240, 31}, kNeutral)), kBackground);
  EXPECT_EQ(tables_->mask({0, 0, 0}, kNeutral), 0x7fffffffu) << "all classes are tested at once";
}

TEST_F(ColorTablesTest, AgreeWithTheBoxesForEveryValueAndLevel) {
  for (const ColorSpace space : kColorSpaces) {
    for (const std::size_t count : {0u, 1u, 13u, 32u}) {
      const ColorBoxes boxes = random_boxes(random_, count);
      ASSERT_TRUE(tables_->build(boxes, space).ok());
      for (int i = 0; i < 60000; ++i) {
        const Channels value = {critical_value(random_, boxes), critical_value(random_, boxes),
                                critical_value(random_, boxes)};
        Channels level = kNeutral;
        if (i % 3 != 0) {
          for (std::uint8_t& l : level) l = static_cast<std::uint8_t>(pick(random_, 0, kLightLevels - 1));
        }
        ASSERT_EQ(tables_->color_of(tables_->mask(value, level)), color_by_boxes(boxes, space, value, level));
      }
    }
  }
}

TEST_F(ColorTablesTest, FullScaleStandsForAllBrighterLight) {
  // Pink at an illumination of 1.25: red saturates at 255, which is corrected to 204, below the class.
  ASSERT_TRUE(tables_->build(boxes_of({{3, {215, 140, 180}, {250, 200, 220}}}), ColorSpace::kRgb).ok());
  const std::uint8_t lamp = level_of_gain(0.8f);
  const Channels level = {lamp, lamp, lamp};
  EXPECT_EQ(tables_->color_of(tables_->mask({255, 220, 250}, level)), 3);
  EXPECT_EQ(tables_->color_of(tables_->mask({254, 220, 250}, level)), kBackground) << "254 is not saturated";
  EXPECT_EQ(tables_->color_of(tables_->mask({255, 255, 250}, level)), kBackground)
      << "a corrected green of 204 or more is above the class";
}

TEST_F(ColorTablesTest, GiveTheColorOfTheLowestBit) {
  ASSERT_TRUE(
      tables_->build(boxes_of({{9, {50, 50, 50}, {60, 60, 60}}, {4, {0, 0, 0}, {255, 255, 255}}}), ColorSpace::kRgb)
          .ok());
  EXPECT_EQ(tables_->color_of(tables_->mask({55, 55, 55}, kNeutral)), 9);
  EXPECT_EQ(tables_->color_of(tables_->mask({55, 55, 61}, kNeutral)), 4);
}

TEST_F(ColorTablesTest, AreUnchangedByInvalidBoxes) {
  ASSERT_TRUE(tables_->build(boxes_of({{3, {1, 1, 1}, {9, 9, 9}}}), ColorSpace::kRgb).ok());
  const ColorId beyond = static_cast<ColorId>(kMaxColors + 1);
  for (const ColorBox& bad : {ColorBox{kBackground, {1, 1, 1}, {2, 2, 2}}, ColorBox{beyond, {1, 1, 1}, {2, 2, 2}},
                              ColorBox{1, {1, 1, 3}, {2, 2, 2}}}) {
    EXPECT_EQ(tables_->build(boxes_of({bad}), ColorSpace::kRgb).code(), ErrorCode::kOutOfRange);
    EXPECT_EQ(tables_->color_of(tables_->mask({5, 5, 5}, kNeutral)), 3);
  }
}

TEST(OverlappingBoxes, AreReportedByTheirIndices) {
  std::size_t first = 99, second = 99;
  const ColorBox red = {1, {100, 0, 0}, {200, 50, 50}};
  const ColorBox beside = {2, {201, 0, 0}, {255, 50, 50}};
  const ColorBox corner = {3, {200, 50, 50}, {210, 90, 90}};
  const ColorBox same_color = {1, {90, 0, 0}, {210, 20, 20}};
  EXPECT_FALSE(overlapping_boxes(boxes_of({}), first, second));
  EXPECT_FALSE(overlapping_boxes(boxes_of({red, beside}), first, second));
  EXPECT_FALSE(overlapping_boxes(boxes_of({red, same_color}), first, second)) << "boxes of one color may overlap";
  ASSERT_TRUE(overlapping_boxes(boxes_of({red, same_color, corner}), first, second)) << "a common corner is an overlap";
  EXPECT_EQ(first, 0u);
  EXPECT_EQ(second, 2u);
  ASSERT_TRUE(overlapping_boxes(boxes_of({red, beside, corner}), first, second));
  EXPECT_EQ(first, 0u);
  ASSERT_TRUE(overlapping_boxes(boxes_of({corner, red}), first, second)) << "in the other order";
  ASSERT_TRUE(overlapping_boxes(boxes_of({beside, corner}), first, second));
  EXPECT_EQ(first, 0u);
  EXPECT_EQ(second, 1u);
}

}  // namespace
}  // namespace touchline::testing
