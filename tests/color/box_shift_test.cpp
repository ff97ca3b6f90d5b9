#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "core/color/box_shift.h"
#include "core/color/row_classifier.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

ColorBoxes two_neighbors() {
  ColorBoxes boxes;
  boxes.push_back({1, {100, 50, 50}, {150, 100, 100}});
  boxes.push_back({2, {153, 50, 50}, {200, 100, 255}});
  return boxes;
}

BoxShift shift_of(const ColorBoxes& boxes, float most = 20) {
  BoxShift shift;
  EXPECT_TRUE(shift.configure(boxes, most).ok());
  return shift;
}

TEST(BoxShift, RejectsInvalidBoxesAndLimits) {
  BoxShift shift;
  ColorBoxes bad;
  bad.push_back({1, {9, 0, 0}, {8, 0, 0}});
  EXPECT_EQ(shift.configure(bad, 5).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(shift.configure(two_neighbors(), -1).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(shift.configure(two_neighbors(), std::numeric_limits<float>::quiet_NaN()).code(), ErrorCode::kOutOfRange);
}

TEST(BoxShift, FollowsObservationsInBoundedStepsUpToTheLimit) {
  BoxShift shift = shift_of(two_neighbors(), 6);
  shift.observe(1, {4, -100, 100}, 0.25f);
  EXPECT_FLOAT_EQ(shift.of(1)[0], 1.0f);
  EXPECT_FLOAT_EQ(shift.of(1)[1], -0.25f * BoxShift::kMaxStep_levels);
  EXPECT_FLOAT_EQ(shift.of(2)[0], 0.0f) << "each color has its own shift";
  for (int i = 0; i < 1000; ++i) shift.observe(1, {4, -100, 100}, 0.25f);
  EXPECT_NEAR(shift.of(1)[0], 4.0f, 1e-3f);
  EXPECT_FLOAT_EQ(shift.of(1)[1], -6.0f);
  EXPECT_FLOAT_EQ(shift.of(1)[2], 6.0f);
  shift.reset();
  EXPECT_FLOAT_EQ(shift.of(1)[2], 0.0f);
}

TEST(BoxShift, ObservationsCorrectAKnownShift) {
  BoxShift shift = shift_of(two_neighbors(), 6);
  shift.set_known(1, {4, -20, 0});
  EXPECT_EQ(shift.of(1), (std::array<float, 3>{4, -6, 0}));
  EXPECT_EQ(shift.moved()[0].low, (Channels{104, 44, 50}));
  EXPECT_EQ(shift.of(2), (std::array<float, 3>{0, 0, 0}));
  for (int i = 0; i < 1000; ++i) shift.observe(1, {3, -6, 2}, 0.25f);
  EXPECT_NEAR(shift.of(1)[0], 3.0f, 1e-3f);
  EXPECT_NEAR(shift.of(1)[1], -6.0f, 1e-3f);
  EXPECT_NEAR(shift.of(1)[2], 2.0f, 1e-3f);
  shift.reset();
  EXPECT_EQ(shift.of(1), (std::array<float, 3>{0, 0, 0}));
}

TEST(BoxShift, DoesNotMoveSidesAtTheEndOfTheScale) {
  BoxShift shift = shift_of(two_neighbors());
  for (int i = 0; i < 200; ++i) shift.observe(2, {0, -7.4f, 9.6f}, 0.5f);
  const ColorBoxes moved = shift.moved();
  EXPECT_EQ(moved[0].low, two_neighbors()[0].low);
  EXPECT_EQ(moved[0].high, two_neighbors()[0].high);
  EXPECT_EQ(moved[1].low, (Channels{153, 43, 60}));
  EXPECT_EQ(moved[1].high, (Channels{200, 93, 255}));
}

TEST(BoxShift, BoxesThatWouldOverlapEndHalfway) {
  BoxShift shift = shift_of(two_neighbors());
  for (int i = 0; i < 200; ++i) {
    shift.observe(1, {10, 0, 0}, 0.5f);
    shift.observe(2, {-4, 0, 0}, 0.5f);
  }
  // The sides at 160 and 149 would overlap.
  const ColorBoxes moved = shift.moved();
  EXPECT_EQ(moved[0].high[0], 154);
  EXPECT_EQ(moved[1].low[0], 155);
  EXPECT_EQ(moved[0].low[0], 110);
  EXPECT_EQ(moved[1].high[0], 196);
}

TEST(BoxShift, TwoColorsThatCannotBothMoveDoNotHoldTheOthers) {
  // The first two pass each other; nothing is left of the narrow one.
  ColorBoxes boxes;
  boxes.push_back({1, {100, 50, 50}, {103, 100, 100}});
  boxes.push_back({2, {105, 50, 50}, {140, 100, 100}});
  boxes.push_back({3, {200, 50, 50}, {220, 100, 100}});
  BoxShift shift = shift_of(boxes);
  shift.set_known(1, {20, 0, 0});
  shift.set_known(2, {-20, 0, 0});
  shift.set_known(3, {5, 0, 0});
  const ColorBoxes moved = shift.moved();
  for (const std::size_t held : {0U, 1U}) {
    EXPECT_EQ(moved[held].low, boxes[held].low);
    EXPECT_EQ(moved[held].high, boxes[held].high);
  }
  EXPECT_EQ(moved[2].low[0], 205);
  EXPECT_EQ(moved[2].high[0], 225);
}

TEST(BoxShift, BoxesOfTwoColorsNeverOverlap) {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    ColorBoxes boxes;
    for (const ColorBox& box : random_boxes(random, 12)) {
      boxes.push_back(box);
      std::size_t a = 0, b = 0;
      if (overlapping_boxes(boxes, a, b)) boxes.pop_back();
    }
    BoxShift shift = shift_of(boxes);
    for (const ColorBox& box : boxes) {
      const auto off = [&] { return static_cast<float>(pick(random, -25, 25)); };
      const std::array<float, 3> by = {off(), off(), off()};
      for (int i = 0; i < 60; ++i) shift.observe(box.color, by, 0.5f);
    }
    const ColorBoxes moved = shift.moved();
    EXPECT_TRUE(check(moved).ok());
    std::size_t a = 0, b = 0;
    EXPECT_FALSE(overlapping_boxes(moved, a, b)) << "round " << round;
  }
}

// Tables that were rebuilt one by one give the same classes as tables built from the moved boxes.
TEST(BoxShift, RebuiltTablesAreThoseOfTheMovedBoxes) {
  std::mt19937 random(6);
  for (const PixelFormat format : kAllFormats) {
    ColorBoxes boxes = two_neighbors();
    LightMap light;
    light.columns = 2;
    light.rows = 1;
    for (auto& plane : light.illumination) {
      plane[0] = 0.7f;
      plane[1] = 1.3f;
    }
    auto followed = std::make_unique<RowClassifier>(), fresh = std::make_unique<RowClassifier>();
    ASSERT_TRUE(followed->configure(format, 64, 16, boxes, light, KernelChoice::kFastest, 12).ok());
    BoxShift shift = shift_of(boxes, 12);
    for (int i = 0; i < 200; ++i) {
      shift.observe(1, {-11, 5, 3}, 0.5f);
      shift.observe(2, {6, -12, -12}, 0.5f);
    }
    const ColorBoxes moved = shift.moved();
    ASSERT_TRUE(fresh->configure(format, 64, 16, moved, light, KernelChoice::kPortable).ok());
    for (std::size_t channel = 0; channel < 3; ++channel) {
      for (std::uint8_t level = 0; level < kLightLevels; ++level) followed->rebuild_tables(moved, channel, level);
    }
    OwnedPicture picture(format, 64, 16, 0);
    for (int v = 0; v < 16; ++v) {
      for (int u = 0; u < 64; ++u) {
        picture.set(u, v,
                    {critical_value(random, moved), critical_value(random, moved), critical_value(random, moved)});
      }
    }
    const Frame frame = picture.frame();
    std::array<ColorId, 64 + 8> one{}, other{};
    for (std::uint16_t v = 0; v < 16; ++v) {
      followed->classify(frame, v, 0, 64, one.data());
      fresh->classify(frame, v, 0, 64, other.data());
      EXPECT_EQ(one, other) << name_of(format) << " row " << v;
    }
  }
}

}  // namespace
}  // namespace touchline::testing
