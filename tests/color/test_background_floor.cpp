#include <gtest/gtest.h>

#include <algorithm>

#include "core/color/background_floor.h"
#include "core/color/load_word.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

TEST(FloorsOf, TakesForEachBoxAChannelThatItNeeds) {
  ColorBoxes boxes;
  EXPECT_EQ(floors_of(boxes), (ChannelFloors{256, 256, 256})) << "no box needs anything";
  boxes.push_back({1, {180, 0, 0}, {255, 80, 80}});
  EXPECT_EQ(floors_of(boxes), (ChannelFloors{180, 256, 256}));
  boxes.push_back({2, {20, 0, 120}, {90, 90, 255}});
  EXPECT_EQ(floors_of(boxes), (ChannelFloors{180, 256, 120}));
  boxes.push_back({3, {0, 0, 0}, {9, 9, 9}});
  const ChannelFloors none = floors_of(boxes);
  EXPECT_EQ(std::min({none[0], none[1], none[2]}), 0) << "black is a color: nothing is below it";
}

TEST(FloorsOf, NoBoxReachesBelow) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    const ColorBoxes boxes = random_boxes(random, static_cast<std::size_t>(pick(random, 0, kMaxColorBoxes)));
    const ChannelFloors floors = floors_of(boxes);
    std::uint32_t gray = 256;  // the simplest admissible choice: one floor for all channels
    for (const ColorBox& box : boxes) {
      EXPECT_TRUE(box.low[0] >= floors[0] || box.low[1] >= floors[1] || box.low[2] >= floors[2]);
      gray = std::min<std::uint32_t>(gray, *std::max_element(box.low.begin(), box.low.end()));
    }
    EXPECT_GE(std::uint32_t{floors[0]} * floors[1] * floors[2], gray * gray * gray);
  }
}

TEST(FloorBeforeCorrection, IsTheFirstValueThatReachesIt) {
  for (const std::uint8_t unlit : std::initializer_list<std::uint8_t>{0, 16, 128}) {
    for (int floor = 0; floor <= 256; floor += 4) {
      for (std::uint8_t level = 0; level < kLightLevels; level += 3) {
        int first = 0;
        // 255 stands for all that is brighter, so that it may reach any floor but 256.
        while (first < 255 && corrected(static_cast<std::uint8_t>(first), level, unlit) < floor) ++first;
        if (floor == 256) first = 256;
        EXPECT_EQ(floor_before_correction(static_cast<std::uint16_t>(floor), level, unlit), first);
      }
    }
  }
}

// Each byte of a block against the floor of its own channel, one value at a time.
TEST(BackgroundFloor, SeesAnySingleByteThatReachesItsFloor) {
  for (const PixelFormat format : kAllFormats) {
    for (const ChannelFloors& floors :
         {ChannelFloors{1, 128, 129}, ChannelFloors{200, 255, 256}, ChannelFloors{127, 90, 254}}) {
      const BackgroundFloor floor(format, floors);
      for (int u = 0; u < static_cast<int>(kBlockPixels); ++u) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
          for (int value = 0; value < 256; ++value) {
            OwnedPicture picture(format, kBlockPixels, 1, 0);
            Channels pixel = {0, 0, 0};
            pixel[channel] = static_cast<std::uint8_t>(value);
            picture.set(u, 0, pixel);
            const Frame frame = picture.frame();
            const std::uint8_t* bytes = frame.plane[0];
            bool rejects = false;
            if (color_space(format) == ColorSpace::kRgb) {
              rejects = floor.rejects(std::array{load_word(bytes), load_word(bytes + 8), load_word(bytes + 16)});
            } else {
              rejects = floor.rejects(
                  std::array{load_word(bytes), load_word(format == PixelFormat::kNv12 ? frame.plane[1] : bytes + 8)});
            }
            ASSERT_EQ(rejects, value < floors[channel])
                << name_of(format) << " pixel " << u << " channel " << channel << " value " << value;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchline::testing
