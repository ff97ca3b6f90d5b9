#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "core/color/background_box.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

bool contains(const BackgroundBox& background, const Channels& value) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (value[c] < background.low[c] || value[c] > background.high[c]) return false;
  }
  return background.exists;
}

bool overlaps(const BackgroundBox& background, const ColorBox& box) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (box.low[c] > background.high[c] || box.high[c] < background.low[c]) return false;
  }
  return true;
}

TEST(BackgroundBox, ExcludesEachColorBoxInAChannelThatSeparatesIt) {
  ColorBoxes boxes;
  const BackgroundBox everything = find_background_box(boxes, ColorSpace::kRgb);
  EXPECT_TRUE(contains(everything, {0, 0, 0}) && contains(everything, {255, 255, 255}));
  boxes.push_back({1, {180, 0, 0}, {255, 80, 80}});
  EXPECT_EQ(find_background_box(boxes, ColorSpace::kRgb).high, (Channels{179, 255, 255}));
  boxes.push_back({2, {20, 0, 120}, {90, 90, 255}});
  EXPECT_EQ(find_background_box(boxes, ColorSpace::kRgb).high, (Channels{179, 255, 119}));
  boxes.push_back({3, {0, 0, 0}, {9, 9, 9}});
  EXPECT_FALSE(find_background_box(boxes, ColorSpace::kRgb).exists) << "black is a color";
}

TEST(BackgroundBox, ContainsLowChromaInYuv) {
  ColorBoxes boxes;
  boxes.push_back({1, {50, 150, 90}, {200, 200, 140}});    // blue
  boxes.push_back({2, {50, 80, 160}, {200, 140, 220}});    // red
  boxes.push_back({3, {180, 100, 100}, {255, 150, 150}});  // white
  boxes.push_back({4, {60, 60, 70}, {190, 108, 110}});     // green: U excludes more chroma
  const BackgroundBox background = find_background_box(boxes, ColorSpace::kYuv);
  ASSERT_TRUE(background.exists);
  EXPECT_EQ(background.low, (Channels{0, 0, 111}));
  EXPECT_EQ(background.high, (Channels{179, 149, 159}));
}

// A gray floor lies between dark green, which has less red, and brown, so no box contains both the floor and black.
TEST(BackgroundBox, ContainsTheTypicalBackground) {
  ColorBoxes boxes;
  boxes.push_back({1, {0, 46, 0}, {47, 123, 101}});
  boxes.push_back({2, {76, 11, 0}, {158, 124, 69}});
  boxes.push_back({3, {0, 0, 129}, {255, 255, 255}});
  const Channels floor = {58, 61, 59};
  EXPECT_FALSE(contains(find_background_box(boxes, ColorSpace::kRgb), floor));
  const BackgroundBox background = find_background_box(boxes, ColorSpace::kRgb, floor);
  EXPECT_EQ(background.low, (Channels{48, 0, 0}));
  EXPECT_EQ(background.high, (Channels{75, 255, 128}));
  boxes.push_back({4, {50, 50, 50}, {60, 70, 80}});
  EXPECT_FALSE(find_background_box(boxes, ColorSpace::kRgb, floor).exists) << "the floor is a color";
}

TEST(BackgroundBox, OverlapsNoColorBox) {
  std::mt19937 random(3);
  std::size_t existing = 0;
  for (int round = 0; round < 300; ++round) {
    const ColorSpace space = kColorSpaces[static_cast<std::size_t>(round) % kColorSpaces.size()];
    ColorBoxes boxes;
    for (const ColorBox& box : random_boxes(random, static_cast<std::size_t>(pick(random, 0, kMaxColorBoxes)))) {
      const bool is_black = box.low[0] <= black_value(space, 0) && box.low[1] <= black_value(space, 1) &&
                            box.low[2] <= black_value(space, 2);
      if (!is_black || round % 5 == 0) boxes.push_back(box);
    }
    const BackgroundBox background = find_background_box(boxes, space);
    if (!background.exists) continue;
    ++existing;
    EXPECT_TRUE(contains(background, {black_value(space, 0), black_value(space, 1), black_value(space, 2)}));
    for (const ColorBox& box : boxes) EXPECT_FALSE(overlaps(background, box));
    if (is_yuv(space)) continue;
    std::uint32_t gray = 256, volume = 1;  // the simplest choice: one bound for all channels
    for (const ColorBox& box : boxes)
      gray = std::min<std::uint32_t>(gray, *std::max_element(box.low.begin(), box.low.end()));
    for (const std::uint8_t high : background.high) volume *= high + 1u;
    EXPECT_GE(volume, gray * gray * gray);
  }
  EXPECT_GT(existing, 150u);
}

TEST(BeforeCorrection, GivesTheValuesThatAreCorrectedIntoTheRange) {
  for (const std::uint8_t black : std::initializer_list<std::uint8_t>{0, 16, 128}) {
    for (int low = 0; low <= 255; low += 15) {
      for (int high = low; high <= 255; high += 15) {
        for (std::uint8_t level = 0; level < kLightLevels; level += 3) {
          const ValueRange range =
              before_correction({static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(high)}, level, black);
          for (int value = 0; value < 256; ++value) {
            const int seen = corrected(static_cast<std::uint8_t>(value), level, black);
            // 255 also stands for all brighter light.
            const bool is_in = low <= seen && (value == 255 ? 255 : seen) <= high;
            ASSERT_EQ(range.low <= value && value <= range.high, is_in)
                << value << " at level " << int{level} << ", range " << low << " to " << high;
          }
        }
      }
    }
  }
}

// Brown can move to the floor's chroma and to black if it may move far.
TEST(BackgroundRanges, ExistForBoxesThatStayNear) {
  ColorBoxes boxes;
  boxes.push_back({1, {0, 61, 137}, {125, 133, 172}});
  const TypicalBackground floor = {{59, 127, 127}};
  const auto ranges = std::make_unique<BackgroundRanges>();
  ranges->build(PixelFormat::kYuvj422p, boxes, 10, floor);
  EXPECT_FALSE(ranges->exist());
  ranges->build(PixelFormat::kYuvj422p, boxes, 4, floor);
  EXPECT_TRUE(ranges->exist());
}

// No box contains the floor and, between green and brown, also the grey carpet around it. The pale box contains it.
TEST(BackgroundRanges, ThePaleBoxContainsFloorCarpetAndLines) {
  ColorBoxes boxes;
  boxes.push_back({1, {81, 61, 29}, {140, 135, 118}});
  boxes.push_back({2, {38, 92, 143}, {124, 129, 179}});
  boxes.push_back({3, {113, 140, 98}, {201, 202, 151}});
  const Channels floor = {59, 127, 127}, carpet = {98, 124, 131}, line = {200, 126, 128};
  const auto ranges = std::make_unique<BackgroundRanges>();
  ranges->build(PixelFormat::kYuvj422p, boxes, 4, floor);
  const TileParameters light = ranges->of({kNeutralLevel, kNeutralLevel, kNeutralLevel});
  TileParameters pale;
  ASSERT_TRUE(ranges->find_pale({&light, 1}, pale));
  const auto is_in = [](const TileParameters& tile, const Channels& value) {
    const auto at = background_bytes(PixelFormat::kYuvj422p);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto above = static_cast<std::uint8_t>(value[c] - tile.background_low[at[c]]);
      if (above > tile.background_extent[at[c]]) return false;
    }
    return true;
  };
  EXPECT_TRUE(is_in(light, floor));
  EXPECT_FALSE(is_in(light, carpet));
  for (const Channels& value : {floor, carpet, line}) EXPECT_TRUE(is_in(pale, value)) << int{value[0]};
  ranges->build(PixelFormat::kRgb24, boxes, 4);
  EXPECT_FALSE(ranges->find_pale({&light, 1}, pale)) << "grey is no box in RGB";
}

// No value in the pale range has a class at any of its light levels, for any permitted shift of the boxes.
TEST(BackgroundRanges, ThePaleRangeContainsOnlyBackground) {
  std::mt19937 random(6);
  const auto tables = std::make_unique<ColorTables>();
  const auto ranges = std::make_unique<BackgroundRanges>();
  int found = 0;
  for (const PixelFormat format : kAllFormats) {
    for (int round = 0; round < 40; ++round) {
      ColorBoxes boxes = random_boxes(random, 9);
      for (ColorBox& box : boxes) {
        const std::size_t c = 1 + random() % 2;
        box.low[c] = std::max<std::uint8_t>(box.low[c], 150);
        box.high[c] = std::max(box.low[c], box.high[c]);
      }
      const ColorBoxes configured = boxes;
      ranges->build(format, boxes, 4, round % 2 == 0 ? TypicalBackground{} : TypicalBackground{{60, 128, 128}});
      for (ColorBox& box : boxes) {
        for (std::uint8_t& low : box.low) low = static_cast<std::uint8_t>(std::max(0, low - pick(random, 0, 4)));
        for (std::uint8_t& high : box.high) high = static_cast<std::uint8_t>(std::min(255, high + pick(random, 0, 4)));
      }
      ASSERT_TRUE(have_moved_within(4, boxes, configured));
      ASSERT_TRUE(tables->build(boxes, color_space(format)).ok());
      std::array<TileParameters, 3> tiles;
      for (TileParameters& tile : tiles) {
        Channels level;
        for (std::uint8_t& of_channel : level) of_channel = static_cast<std::uint8_t>(pick(random, 50, 80));
        tile = ranges->of(level);
      }
      TileParameters pale;
      if (!ranges->find_pale(tiles, pale)) continue;
      ++found;
      const auto at = background_bytes(format);
      for (int i = 0; i < 200; ++i) {
        Channels value;
        for (std::size_t c = 0; c < 3; ++c) {
          const int extent = pale.background_extent[at[c]];
          const int above = i < 8 ? (i >> c & 1) * extent : pick(random, 0, extent);
          value[c] = static_cast<std::uint8_t>(pale.background_low[at[c]] + above);
        }
        for (const TileParameters& tile : tiles) {
          ASSERT_EQ(tables->mask(value, {tile.level[0], tile.level[1], tile.level[2]}), 0u) << name_of(format);
        }
      }
    }
  }
  EXPECT_GT(found, 50);
}

// No value in the ranges has a class, at any light level and for any permitted shift of the boxes.
TEST(BackgroundRanges, ContainOnlyBackground) {
  std::mt19937 random(4);
  const auto tables = std::make_unique<ColorTables>();
  const auto ranges = std::make_unique<BackgroundRanges>();
  std::size_t not_from_unlit = 0;
  for (const PixelFormat format : kAllFormats) {
    for (int round = 0; round < 8; ++round) {
      ColorBoxes boxes = random_boxes(random, 9);
      for (ColorBox& box : boxes) {
        const std::size_t c = random() % 3;
        box.low[c] = std::max<std::uint8_t>(box.low[c], 190);
        box.high[c] = std::max(box.low[c], box.high[c]);
      }
      const auto floor = static_cast<std::uint8_t>(pick(random, 0, 184));
      const TypicalBackground background = {{floor, floor, floor}};
      ranges->build(format, boxes, 5, round < 4 ? TypicalBackground{} : background);
      ASSERT_TRUE(ranges->exist());
      for (ColorBox& box : boxes) {
        for (std::uint8_t& low : box.low) low = static_cast<std::uint8_t>(std::max(0, low - pick(random, 0, 5)));
        for (std::uint8_t& high : box.high) high = static_cast<std::uint8_t>(std::min(255, high + pick(random, 0, 5)));
      }
      ASSERT_TRUE(tables->build(boxes, color_space(format)).ok());
      for (int tile = 0; tile < 200; ++tile) {
        Channels level, value;
        for (std::uint8_t& of_channel : level) of_channel = static_cast<std::uint8_t>(random() % kLightLevels);
        const TileParameters light = ranges->of(level);
        const auto at = background_bytes(format);
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_EQ(light.level[c], level[c]);
          const int low = light.background_low[at[c]];
          value[c] = static_cast<std::uint8_t>(low + pick(random, 0, 1) * light.background_extent[at[c]]);
          if (ranges->begin_at_zero()) {
            ASSERT_EQ(low, 0);
          }
          not_from_unlit += std::size_t{low > black_value(color_space(format), c)};
        }
        ASSERT_EQ(tables->mask(value, level), 0u) << name_of(format);
        if (color_space(format) == ColorSpace::kRgb) continue;
        const std::size_t luma_again = info_of(format).planes > 1 ? 1u : at[0] + 2u;
        ASSERT_EQ(light.background_low[luma_again], light.background_low[at[0]]);
        ASSERT_EQ(light.background_extent[luma_again], light.background_extent[at[0]]);
      }
    }
  }
  EXPECT_GT(not_from_unlit, 100u);
}

// At a gain of 1/4, full scale becomes 64, so no pixel value corresponds to this floor.
TEST(BackgroundRanges, FallBackToBlackWhereNoValueIsTheFloor) {
  ColorBoxes boxes;
  boxes.push_back({1, {0, 90, 0}, {99, 255, 255}});
  const auto ranges = std::make_unique<BackgroundRanges>();
  ranges->build(PixelFormat::kRgb24, boxes, 0, TypicalBackground{{120, 120, 120}});
  EXPECT_EQ(ranges->of({kNeutralLevel, kNeutralLevel, kNeutralLevel}).background_low,
            (std::array<std::uint8_t, 4>{100}));
  const TileParameters dark = ranges->of({0, 0, 0});
  EXPECT_EQ(dark.background_low, (std::array<std::uint8_t, 4>{}));
  EXPECT_EQ(dark.background_extent[0], 255);
  EXPECT_LT(corrected(dark.background_extent[1], 0, 0), 90);
}

}  // namespace
}  // namespace touchline::testing
