#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "core/color/row_classifier.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr ColorId kUntouched = 0xee;

class RowClassifierTest : public ::testing::TestWithParam<std::tuple<PixelFormat, KernelChoice>> {
 protected:
  // Classifies columns [begin, end) of every row and compares them with the definition. Other columns must not change.
  void expect_defined_colors(const OwnedPicture& picture, const ColorBoxes& boxes, std::uint16_t begin,
                             std::uint16_t end) {
    const Frame frame = picture.frame();
    const ColorSpace space = color_space(frame.format);
    std::vector<ColorId> colors(static_cast<std::size_t>(picture.width()));
    for (std::uint16_t v = 0; v < frame.height_px; ++v) {
      std::fill(colors.begin(), colors.end(), kUntouched);
      classifier_->classify(frame, v, begin, end, colors.data());
      for (std::uint16_t u = 0; u < frame.width_px; ++u) {
        Channels level = {kNeutralLevel, kNeutralLevel, kNeutralLevel};
        const Shading& shading = classifier_->shading();
        for (std::size_t c = 0; c < 3 && shading.active(); ++c) {
          level[c] = shading.level(c, u / kTileWidth, v / kTileHeight);
        }
        const Channels value = channels_at(frame, u, v);
        const ColorId expected = begin <= u && u < end ? color_by_boxes(boxes, space, value, level) : kUntouched;
        ASSERT_EQ(int{colors[u]}, int{expected}) << "(" << u << ", " << v << ") of columns " << begin << " to " << end;
      }
    }
  }

  static LightMap random_light(std::mt19937& random) {
    LightMap light;
    light.columns = static_cast<std::uint16_t>(pick(random, 1, 9));
    light.rows = static_cast<std::uint16_t>(pick(random, 1, 9));
    for (auto& plane : light.illumination) {
      for (int i = 0; i < light.columns * light.rows; ++i) {
        plane[static_cast<std::size_t>(i)] = static_cast<float>(pick(random, 20, 500)) / 100.0f;
      }
    }
    return light;
  }

  [[nodiscard]] static PixelFormat format() { return std::get<0>(GetParam()); }
  Status configure(const Frame& frame, const ColorBoxes& boxes, const LightMap& light) {
    return classifier_->configure(format(), frame.width_px, frame.height_px, boxes, light, std::get<1>(GetParam()));
  }

  std::unique_ptr<RowClassifier> classifier_ = std::make_unique<RowClassifier>();
  std::mt19937 random_{static_cast<std::uint32_t>(format())};
};

// A box moves, as adaptation does, until it contains what the pale box contained.
TEST_P(RowClassifierTest, FindsTheColorsOfABoxThatMovedToGrey) {
  constexpr std::uint8_t kShiftLimit = 10;
  ColorBoxes boxes;
  boxes.push_back({1, {40, 100, 135}, {220, 150, 200}});
  OwnedPicture picture(format(), 80, 16, 0);
  picture.fill([] { return std::uint8_t{129}; });
  const Frame frame = picture.frame();
  LightMap map;
  map.columns = 2;
  map.rows = 1;
  for (auto& plane : map.illumination) {
    plane[0] = 0.9f;
    plane[1] = 1.1f;
  }
  for (const LightMap& light : {LightMap{}, map}) {
    ASSERT_TRUE(classifier_
                    ->configure(format(), frame.width_px, frame.height_px, boxes, light, std::get<1>(GetParam()),
                                kShiftLimit, TypicalBackground{{100, 128, 128}})
                    .ok());
    expect_defined_colors(picture, boxes, 0, frame.width_px);
    for (const int shift : {4, 10, 6}) {
      ColorBoxes moved = boxes;
      moved[0].low[2] = static_cast<std::uint8_t>(moved[0].low[2] - shift);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::uint8_t level = 0; level < kLightLevels; ++level) classifier_->rebuild_tables(moved, channel, level);
      }
      expect_defined_colors(picture, moved, 0, frame.width_px);
    }
  }
}

TEST_P(RowClassifierTest, AgreesWithTheBoxesOnEveryPixel) {
  for (int round = 0; round < 400; ++round) {
    OwnedPicture picture(format(), pick(random_, 1, 80), pick(random_, 1, 20), pick(random_, 0, 7));
    const Frame frame = picture.frame();
    const ColorBoxes boxes = random_boxes(random_, static_cast<std::size_t>(pick(random_, 0, kMaxColorBoxes)));
    const LightMap light = round % 2 == 0 ? LightMap{} : random_light(random_);
    ASSERT_TRUE(configure(frame, boxes, light).ok());
    picture.fill([&] { return critical_value(random_, boxes); });
    const int begin = pick(random_, 0, picture.width()), end = pick(random_, begin, picture.width());
    ASSERT_NO_FATAL_FAILURE(
        expect_defined_colors(picture, boxes, static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)));
  }
}

TEST_P(RowClassifierTest, AgreesOnEverySmallSizeAndSpan) {
  // Few boxes, none of them dark, and a mostly dark picture: whole blocks are rejected between others that are not.
  ColorBoxes boxes;
  boxes.push_back({1, {0, 150, 0}, {255, 255, 120}});
  boxes.push_back({2, {90, 0, 160}, {200, 100, 255}});
  const auto dark_or_critical = [&](bool dark) {
    return dark ? static_cast<std::uint8_t>(pick(random_, 0, 89)) : critical_value(random_, boxes);
  };
  for (int width = 1; width <= 35; ++width) {
    OwnedPicture picture(format(), width, 3, 1);
    const Frame frame = picture.frame();
    ASSERT_TRUE(configure(frame, boxes, LightMap{}).ok());
    for (std::uint16_t begin = 0; begin <= width; ++begin) {
      int byte = 0;
      picture.fill([&] { return dark_or_critical(++byte % 29 != 0); });
      for (std::uint16_t end = begin; end <= width; ++end) {
        ASSERT_NO_FATAL_FAILURE(expect_defined_colors(picture, boxes, begin, end));
      }
    }
  }
}

TEST_P(RowClassifierTest, AgreesOnOnePictureOfTheLargestWidth) {
  OwnedPicture picture(format(), static_cast<int>(kMaxFrameWidth), 17, 32);
  const Frame frame = picture.frame();
  const ColorBoxes boxes = random_boxes(random_, 13);
  picture.fill([&] { return critical_value(random_, boxes); });
  for (const LightMap& light : {LightMap{}, random_light(random_)}) {
    ASSERT_TRUE(configure(frame, boxes, light).ok());
    ASSERT_NO_FATAL_FAILURE(expect_defined_colors(picture, boxes, 0, frame.width_px));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, RowClassifierTest,
                         ::testing::Combine(::testing::ValuesIn(kAllFormats),
                                            ::testing::Values(KernelChoice::kFastest, KernelChoice::kPortable)),
                         [](const auto& test) {
                           const bool portable = std::get<1>(test.param) == KernelChoice::kPortable;
                           return std::string(name_of(std::get<0>(test.param))) + (portable ? "_portable" : "_fastest");
                         });

TEST(RowBytes, CountWholePixelPairs) {
  EXPECT_EQ(row_bytes(PixelFormat::kRgb24, 0, 7), 21u);
  EXPECT_EQ(row_bytes(PixelFormat::kYuyv, 0, 7), 16u);
  EXPECT_EQ(row_bytes(PixelFormat::kUyvy, 0, 8), 16u);
  EXPECT_EQ(row_bytes(PixelFormat::kNv12, 0, 7), 7u);
  EXPECT_EQ(row_bytes(PixelFormat::kNv12, 1, 7), 8u);
  EXPECT_EQ(row_bytes(PixelFormat::kBgr24, 1, 7), 0u);
}

}  // namespace
}  // namespace touchline::testing
