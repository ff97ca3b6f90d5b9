#include <gtest/gtest.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <tuple>

#include "core/color/nibble_tables.h"
#include "core/color/row_classifier.h"
#include "core/color/span_kernel.h"
#include "tests/color/kernels.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr ColorId kUnwritten = 0xee;

TEST(NibbleTables, GiveTheClassesOfTheColorTablesForEveryValue) {
  std::mt19937 random(17);
  const auto tables = std::make_unique<ColorTables>();
  const auto nibbles = std::make_unique<NibbleTables>();
  for (const std::size_t count : {0u, 1u, 8u, 9u, 13u, 32u}) {
    for (const ColorSpace space : kColorSpaces) {
      const ColorBoxes boxes = random_boxes(random, count);
      ASSERT_TRUE(tables->build(boxes, space).ok());
      nibbles->build(*tables, boxes.size());
      ASSERT_EQ(nibbles->groups(), (count + 7) / 8);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::uint8_t level = 0; level < kLightLevels; ++level) {
          for (std::size_t value = 0; value < 256; ++value) {
            std::uint32_t mask = 0;
            for (std::size_t group = 0; group < kClassGroups; ++group) {
              const ChannelNibbles& t = nibbles->channel(channel, level);
              const std::size_t high = value / 16, low = value % 16;
              const std::uint32_t bits = t.within[group][high] &
                                         (t.above_first[group][high] | t.from_first[group][low]) &
                                         (t.below_last[group][high] | t.to_last[group][low]);
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

TEST(NibbleTables, GiveTheColorOfTheLowestClass) {
  std::mt19937 random(18);
  const auto tables = std::make_unique<ColorTables>();
  const auto nibbles = std::make_unique<NibbleTables>();
  ASSERT_TRUE(tables->build(random_boxes(random, kMaxColorBoxes), ColorSpace::kRgb).ok());
  nibbles->build(*tables, kMaxColorBoxes);
  for (std::size_t group = 0; group < kClassGroups; ++group) {
    const NibbleLookup &low = nibbles->colors().low[group], &high = nibbles->colors().high[group];
    for (std::uint32_t bits = 0; bits < 256; ++bits) {
      const ColorId color = low[bits % 16] != kBackground ? low[bits % 16] : high[bits / 16];
      EXPECT_EQ(color, tables->color_of(bits << 8 * group)) << "group " << group << ", bits " << bits;
    }
  }
}

TEST(FindSpanKernel, ReturnsTheFastestOrTheNamedKernel) {
  for (const PixelFormat format : kAllFormats) {
    KernelChoice choice = KernelChoice::kPortable;
    EXPECT_EQ(find_span_kernel(format, choice), portable_span_kernel(format));
    choice = KernelChoice::kFastest;
    const SpanKernel fastest = find_span_kernel(format, choice);
    ASSERT_NE(choice, KernelChoice::kFastest);
    for (const KernelChoice named : {KernelChoice::kAvx2, KernelChoice::kNeon}) {
      KernelChoice kept = named;
      const SpanKernel kernel = find_span_kernel(format, kept);
      EXPECT_EQ(kept, named);
      EXPECT_EQ(kernel == fastest, named == choice) << word_of(named);
    }
  }
  for (std::size_t i = 0; i < kKernelChoices.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kKernelChoices[i].value), i);
  }
}

// Compares the kernels of instruction sets with the portable one, row by row.
class SpanKernelTest : public ::testing::TestWithParam<std::tuple<PixelFormat, KernelChoice>> {
 protected:
  void SetUp() override {
    KernelChoice choice = std::get<1>(GetParam());
    kernel_ = find_span_kernel(format(), choice);
    if (kernel_ == nullptr) GTEST_SKIP() << "this processor does not support " << word_of(choice);
    for (std::uint8_t& byte : bytes_) byte = static_cast<std::uint8_t>(random_());
  }

  [[nodiscard]] static PixelFormat format() { return std::get<0>(GetParam()); }

  void choose_colors(std::size_t count) {
    boxes_ = random_boxes(random_, count);
    background_.reset();
    if (const int kind = pick(random_, 0, 3); kind == 1) {
      // No box contains the typical background, which is as likely to be bright as dark.
      const auto floor = static_cast<std::uint8_t>(pick(random_, 0, 255));
      background_ = {floor, floor, floor};
      for (ColorBox& box : boxes_) {
        const std::size_t channel = random_() % 3;
        if (floor < 128) box.low[channel] = std::max<std::uint8_t>(box.low[channel], floor + 15);
        if (floor >= 128) box.high[channel] = std::min<std::uint8_t>(box.high[channel], floor - 15);
        box.low[channel] = std::min(box.low[channel], box.high[channel]);
        box.high[channel] = std::max(box.low[channel], box.high[channel]);
      }
    } else if (kind != 0) {
      // No box is dark, so that the background box can reject whole blocks.
      for (ColorBox& box : boxes_) {
        const std::size_t channel = random_() % 3;
        box.low[channel] = std::max<std::uint8_t>(box.low[channel], 180);
        box.high[channel] = std::max(box.high[channel], box.low[channel]);
      }
    }
    make_tables();
  }

  void make_tables() {
    ASSERT_TRUE(tables_->build(boxes_, color_space(format())).ok());
    nibbles_->build(*tables_, boxes_.size());
    ranges_->build(format(), boxes_, 0, background_);
    for (TileParameters& tile : lights_) {
      // In half of the cases, the pixel repeats its neighbor's value.
      Channels level = {kNeutralLevel, kNeutralLevel, kNeutralLevel};
      for (std::uint8_t& of_channel : level) of_channel = static_cast<std::uint8_t>(pick(random_, 40, 90));
      tile = &tile != lights_.data() && pick(random_, 0, 2) == 0 ? *(&tile - 1) : ranges_->of(level);
    }
    has_pale_ = ranges_->find_pale(lights_, pale_);
  }

  [[nodiscard]] SpanTables tables(bool unshaded) const {
    return {tables_.get(),    nibbles_.get(),           lights_.data(), unshaded,
            ranges_->exist(), ranges_->begin_at_zero(), false,          unshaded ? nullptr : pale()};
  }
  // The second range of a row with a light map. Returns null if it does not exist.
  [[nodiscard]] const TileParameters* pale() const { return has_pale_ ? &pale_ : nullptr; }

  // A row with a light map whose tiles are equal.
  [[nodiscard]] SpanTables tables_of_one_light() {
    equal_lights_.fill(lights_[0]);
    SpanTables out = tables(false);
    out.tiles = equal_lights_.data();
    out.has_one_light = true;
    return out;
  }

  // Sequences of background pixels between others.
  void paint(OwnedPicture& picture) {
    int stretch = 0;
    bool background = false;
    std::uint8_t value = 0;
    picture.fill([&] {
      if (stretch-- == 0) {
        stretch = pick(random_, 1, 300);
        background = !background;
      }
      if (background && background_) return static_cast<std::uint8_t>((*background_)[0] ^ (random_() % 4));
      if (background)
        return static_cast<std::uint8_t>(color_space(format()) == ColorSpace::kRgb ? 0 : 120 + random_() % 8);
      if (random_() % 4 != 0) value = critical_value(random_, boxes_);
      return value;
    });
  }

  // The bytes are prepared in advance, because choosing each one takes too long.
  void paint_fast(OwnedPicture& picture) {
    std::size_t at = random_() % bytes_.size();
    picture.fill([&] { return bytes_[at++ % bytes_.size()]; });
  }

  void expect_equal(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end) {
    expected_.fill(kUnwritten);
    found_.fill(kUnwritten);
    const OccupiedWords least = portable_span_kernel(format())(tables, row, begin, end, expected_.data());
    const OccupiedWords occupied = kernel_(tables, row, begin, end, found_.data());
    ASSERT_EQ(std::memcmp(found_.data(), expected_.data(), found_.size()), 0)
        << "columns " << begin << " to " << end << (tables.unshaded ? "" : " with a light map");
    OccupiedWords in_span = 0, colored = 0;
    for (std::uint32_t u = begin; u < end; ++u) {
      const OccupiedWords word = OccupiedWords{1} << u / kOccupiedWordPixels;
      in_span |= word;
      if (found_[u] != kBackground) ++colored_, colored |= word;
    }
    for (const OccupiedWords words : {least, occupied}) {
      ASSERT_EQ(colored & ~words, 0u) << "colors in words that are reported as background";
      // A block that overlaps two words may report both.
      ASSERT_EQ(words & ~(in_span & (colored | colored << 1 | colored >> 1)), 0u)
          << "a reported word without a color in it or next to it";
    }
  }

  SpanKernel kernel_ = nullptr;
  ColorBoxes boxes_;
  TypicalBackground background_;
  std::unique_ptr<ColorTables> tables_ = std::make_unique<ColorTables>();
  std::unique_ptr<NibbleTables> nibbles_ = std::make_unique<NibbleTables>();
  std::unique_ptr<BackgroundRanges> ranges_ = std::make_unique<BackgroundRanges>();
  std::array<TileParameters, kMaxFrameWidth / kTileWidth> lights_, equal_lights_;
  TileParameters pale_;
  bool has_pale_ = false;
  std::array<std::uint8_t, 4099> bytes_{};
  std::array<ColorId, kMaxFrameWidth> expected_{}, found_{};
  std::mt19937 random_{static_cast<std::uint32_t>(format()) + 70};
  std::size_t colored_ = 0;
};

TEST_P(SpanKernelTest, AgreesWithThePortableKernelOnRandomSpans) {
  for (const std::size_t count : {0u, 1u, 8u, 9u, 13u, 32u}) {
    ASSERT_NO_FATAL_FAILURE(choose_colors(count));
    for (int round = 0; round < 60; ++round) {
      OwnedPicture picture(format(), round == 0 ? static_cast<int>(kMaxFrameWidth - count % 2) : pick(random_, 1, 400),
                           1, 0);
      paint(picture);
      const Frame frame = picture.frame();
      const RowPixels row = row_pixels(frame, 0);
      for (const bool unshaded : {true, false}) {
        ASSERT_NO_FATAL_FAILURE(expect_equal(tables(unshaded), row, 0, frame.width_px));
        const int begin = pick(random_, 0, frame.width_px), end = pick(random_, begin, frame.width_px);
        ASSERT_NO_FATAL_FAILURE(
            expect_equal(tables(unshaded), row, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)));
        ASSERT_NO_FATAL_FAILURE(expect_equal(tables_of_one_light(), row, static_cast<std::uint32_t>(begin),
                                             static_cast<std::uint32_t>(end)));
      }
    }
  }
  EXPECT_GT(colored_, 3000u);
}

TEST_P(SpanKernelTest, AgreesWithThePortableKernelOnEverySpanOfAShortRow) {
  ASSERT_NO_FATAL_FAILURE(choose_colors(13));
  OwnedPicture picture(format(), 150, 1, 0);
  const Frame frame = picture.frame();
  for (std::uint32_t begin = 0; begin <= frame.width_px; ++begin) {
    paint(picture);
    const SpanTables one_light = tables_of_one_light();
    for (std::uint32_t end = begin; end <= frame.width_px; ++end) {
      ASSERT_NO_FATAL_FAILURE(expect_equal(tables(end % 2 == 0), row_pixels(frame, 0), begin, end));
      ASSERT_NO_FATAL_FAILURE(expect_equal(one_light, row_pixels(frame, 0), begin, end));
    }
  }
}

// A kernel tests several tiles at once, and makes several passes over a row. The widths of this test lie around the
// columns at which such a test or pass ends.
TEST_P(SpanKernelTest, AgreesWithThePortableKernelOnSpansOfWholeTests) {
  ASSERT_NO_FATAL_FAILURE(choose_colors(13));
  OwnedPicture picture(format(), kMaxFrameWidth, 1, 0);
  const Frame frame = picture.frame();
  for (const std::uint32_t tests : {64u, 128u, 192u, 256u, 1024u, 1024u + 64u, 1024u + 128u, 2048u, 2048u + 64u}) {
    for (std::uint32_t begin = 0; begin < 4; ++begin) {
      paint(picture);
      const SpanTables one_light = tables_of_one_light();
      for (std::uint32_t width = tests - 2; width < tests + 20; ++width) {
        ASSERT_NO_FATAL_FAILURE(expect_equal(one_light, row_pixels(frame, 0), begin, begin + width));
      }
    }
  }
}

TEST_P(SpanKernelTest, AgreesWithThePortableKernelOnEverySmallPicture) {
  ASSERT_NO_FATAL_FAILURE(choose_colors(13));
  for (int width = 1; width <= 64; ++width) {
    for (int height = 1; height <= 64; ++height) {
      OwnedPicture picture(format(), width, height, (width + height) % 3);
      paint_fast(picture);
      const Frame frame = picture.frame();
      for (std::uint32_t v = 0; v < frame.height_px; ++v) {
        const RowPixels row = row_pixels(frame, v);
        ASSERT_NO_FATAL_FAILURE(expect_equal(tables(v / kTileHeight % 2 == 0), row, 0, frame.width_px));
      }
    }
  }
  EXPECT_GT(colored_, 100000u);
}

// Inaccessible memory pages lie directly before and after the span.
TEST_P(SpanKernelTest, ReadsNothingBeyondTheSpan) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const memory = mmap(nullptr, 9 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::uint8_t* const start = static_cast<std::uint8_t*>(memory);
  // Pages 1, 4 and 7, one for each plane.
  for (const std::size_t number : {1u, 4u, 7u}) {
    ASSERT_EQ(mprotect(start + number * page, page, PROT_READ | PROT_WRITE), 0);
    for (std::size_t i = 0; i < page; ++i) start[number * page + i] = static_cast<std::uint8_t>(random_());
  }
  ASSERT_NO_FATAL_FAILURE(choose_colors(13));
  for (std::uint16_t begin = 0; begin < 70; ++begin) {
    for (std::uint16_t end = begin + 1; end < begin + 140; end = static_cast<std::uint16_t>(end + 1 + end % 3)) {
      // Chroma has whole pairs.
      const auto even_begin = static_cast<std::uint16_t>(begin / 2 * 2);
      RowPixels at_start, at_end;
      for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
        const bool pairs = plane > 0 || info_of(format()).packing == Packing::kPacked422;
        std::uint8_t* const first = start + (1 + 3 * plane) * page;
        at_start.plane[plane] = first - row_bytes(format(), plane, pairs ? even_begin : begin);
        at_end.plane[plane] = first + page - row_bytes(format(), plane, end);
      }
      for (const RowPixels& row : {at_start, at_end}) {
        ASSERT_NO_FATAL_FAILURE(expect_equal(tables(end % 2 == 0), row, begin, end));
        ASSERT_NO_FATAL_FAILURE(expect_equal(tables_of_one_light(), row, begin, end));
      }
    }
  }
  munmap(memory, 9 * page);
}

// If a class contains black, no pixel may be rejected as background.
TEST_P(SpanKernelTest, ClassifiesBlack) {
  for (std::uint8_t bright : {std::uint8_t{3}, std::uint8_t{20}}) {
    boxes_.clear();
    boxes_.push_back({1, {0, 0, 0}, {bright, 255, 255}});
    boxes_.push_back({2, {200, 0, 0}, {255, 255, 255}});
    ASSERT_NO_FATAL_FAILURE(make_tables());
    OwnedPicture picture(format(), 200, 1, 0);
    picture.fill([] { return std::uint8_t{0}; });
    const Frame frame = picture.frame();
    colored_ = 0;
    ASSERT_NO_FATAL_FAILURE(expect_equal(tables(true), row_pixels(frame, 0), 0, 200));
    EXPECT_EQ(colored_, 200u);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, SpanKernelTest,
                         ::testing::Combine(::testing::ValuesIn(kAllFormats), ::testing::ValuesIn(kKernels)),
                         [](const auto& test) {
                           return std::string(name_of(std::get<0>(test.param))) + "_" +
                                  word_of(std::get<1>(test.param));
                         });

}  // namespace
}  // namespace touchline::testing
