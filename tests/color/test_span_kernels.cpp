#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "core/color/digit_tables.h"
#include "core/color/span_kernel.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr ColorId kUntouched = 0xee;

TEST(DigitTables, SayOfEveryValueWhatTheTablesSay) {
  std::mt19937 random(17);
  const auto tables = std::make_unique<ColorTables>();
  const auto digits = std::make_unique<DigitTableSet>();
  for (const std::size_t count : {0u, 1u, 8u, 9u, 13u, 32u}) {
    for (const ColorSpace space : {ColorSpace::kRgb, ColorSpace::kYuv}) {
      const ColorBoxes boxes = random_boxes(random, count);
      ASSERT_TRUE(tables->build(boxes, space).ok());
      digits->build(*tables, boxes.size());
      ASSERT_EQ(digits->groups(), (count + 7) / 8);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::uint8_t level = 0; level < kLightLevels; ++level) {
          for (std::size_t value = 0; value < 256; ++value) {
            std::uint32_t mask = 0;
            for (std::size_t group = 0; group < kClassGroups; ++group) {
              const DigitTables& t = digits->channel(channel, level)[group];
              const std::size_t high = value / 16, low = value % 16;
              const std::uint32_t bits =
                  t.within[high] & (t.above_first[high] | t.from_first[low]) & (t.below_last[high] | t.to_last[low]);
              mask |= bits << 8 * group;
            }
            ASSERT_EQ(mask, tables->table(channel, level)[value])
                << count << " boxes, channel " << channel << ", level " << int{level} << ", value " << value;
          }
        }
      }
    }
  }
}

TEST(DigitTables, GiveTheColorOfTheLowestClass) {
  std::mt19937 random(18);
  const auto tables = std::make_unique<ColorTables>();
  const auto digits = std::make_unique<DigitTableSet>();
  ASSERT_TRUE(tables->build(random_boxes(random, kMaxColorBoxes), ColorSpace::kRgb).ok());
  digits->build(*tables, kMaxColorBoxes);
  for (std::size_t group = 0; group < kClassGroups; ++group) {
    const ColorDigits& colors = digits->colors()[group];
    for (std::uint32_t bits = 0; bits < 256; ++bits) {
      const ColorId color = colors.low[bits % 16] != kBackground ? colors.low[bits % 16] : colors.high[bits / 16];
      EXPECT_EQ(color, tables->color_of(bits << 8 * group)) << "group " << group << ", bits " << bits;
    }
  }
}

// Kernels for some processors against the portable one, on a single row of every length around their blocks.
class SpanKernelTest : public ::testing::TestWithParam<PixelFormat> {
 protected:
  void choose_colors(std::size_t count) {
    boxes_ = random_boxes(random_, count);
    if (pick(random_, 0, 1) == 0) {
      // None of them dark, so that whole blocks can be told from them at a glance.
      for (ColorBox& box : boxes_) {
        const std::size_t channel = random_() % 3;
        box.low[channel] = std::max<std::uint8_t>(box.low[channel], 100);
        box.high[channel] = std::max(box.high[channel], box.low[channel]);
      }
    }
    make_tables(pick(random_, 0, 1) == 0);
  }

  void make_tables(bool neutral) {
    const ColorSpace space = color_space(GetParam());
    ASSERT_TRUE(tables_->build(boxes_, space).ok());
    digits_->build(*tables_, boxes_.size());
    ChannelFloors floors = floors_of(boxes_);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t level =
          neutral ? kNeutralLevel : static_cast<std::uint8_t>(pick(random_, 0, kLightLevels - 1));
      span_.channel[c] = &tables_->table(c, level);
      span_.digits[c] = &digits_->channel(c, level);
      floors[c] = floor_before_correction(floors[c], level, unlit_value(space, c));
    }
    floor_ = BackgroundFloor(GetParam(), floors);
    span_.color_of_bit = &tables_->color_of_bit();
    span_.floor = &floor_;
    span_.color_digits = &digits_->colors();
    span_.groups = digits_->groups();
  }

  // Stretches of dark pixels between others.
  OwnedPicture paint_row(int width) {
    OwnedPicture picture(GetParam(), width, 1, 0);
    int stretch = 0;
    bool dark = false;
    picture.fill([&] {
      if (stretch-- == 0) {
        stretch = pick(random_, 1, 150);
        dark = !dark;
      }
      return dark ? static_cast<std::uint8_t>(pick(random_, 0, 99)) : telling_value(random_, boxes_);
    });
    return picture;
  }

  void expect_equal(SpanKernel kernel, const OwnedPicture& picture, int begin, int end) {
    const Frame frame = picture.frame();
    const RowPixels row = {frame.plane[0], frame.plane[1]};
    std::vector<ColorId> expected(frame.width_px, kUntouched), found = expected;
    const auto from = static_cast<std::uint32_t>(begin), to = static_cast<std::uint32_t>(end);
    scalar_kernel(GetParam())(span_, row, from, to, expected.data());
    kernel(span_, row, from, to, found.data());
    ASSERT_EQ(std::vector<int>(found.begin(), found.end()), std::vector<int>(expected.begin(), expected.end()))
        << "columns " << begin << " to " << end << " of " << picture.width();
    colored_ += static_cast<std::size_t>(std::count_if(
        found.begin(), found.end(), [](ColorId color) { return color != kBackground && color != kUntouched; }));
  }

  ColorBoxes boxes_;
  std::unique_ptr<ColorTables> tables_ = std::make_unique<ColorTables>();
  std::unique_ptr<DigitTableSet> digits_ = std::make_unique<DigitTableSet>();
  BackgroundFloor floor_;
  SpanTables span_;
  std::mt19937 random_{static_cast<std::uint32_t>(GetParam()) + 70};
  std::size_t colored_ = 0;
};

TEST_P(SpanKernelTest, Avx2IsThePortableOne) {
  const SpanKernel kernel = avx2_kernel(GetParam());
  if (kernel == nullptr) GTEST_SKIP() << "this processor has no AVX2";
  for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 13u, 17u, 32u}) {
    for (int round = 0; round < 3; ++round) {
      ASSERT_NO_FATAL_FAILURE(choose_colors(count));
      for (int width = 1; width <= 200; ++width) {
        const OwnedPicture picture = paint_row(width);
        ASSERT_NO_FATAL_FAILURE(expect_equal(kernel, picture, 0, width));
        const int begin = pick(random_, 0, width), end = pick(random_, begin, width);
        ASSERT_NO_FATAL_FAILURE(expect_equal(kernel, picture, begin, end));
      }
    }
  }
  EXPECT_GT(colored_, 5000u);
}

// A class that contains black: no value is below its floor, and nothing may be taken for background at a glance.
TEST_P(SpanKernelTest, Avx2SeesBlack) {
  const SpanKernel kernel = avx2_kernel(GetParam());
  if (kernel == nullptr) GTEST_SKIP() << "this processor has no AVX2";
  boxes_.push_back({1, {0, 0, 0}, {3, 255, 255}});
  boxes_.push_back({2, {200, 0, 0}, {255, 255, 255}});
  ASSERT_NO_FATAL_FAILURE(make_tables(true));
  OwnedPicture picture(GetParam(), 200, 1, 0);
  picture.fill([] { return std::uint8_t{0}; });
  ASSERT_NO_FATAL_FAILURE(expect_equal(kernel, picture, 0, 200));
  EXPECT_EQ(colored_, 200u);
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, SpanKernelTest, ::testing::ValuesIn(kAllFormats),
                         [](const auto& test) { return std::string(name_of(test.param)); });

}  // namespace
}  // namespace touchline::testing
