#include "hal/linux/frame_counter.h"

#include <gtest/gtest.h>

namespace touchline::hal {
namespace {

TEST(FrameCounter, GapsAreLostFrames) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(7), 7u);
  EXPECT_EQ(counter.count(8), 8u);
  EXPECT_EQ(counter.count(11), 11u);
  EXPECT_EQ(counter.lost(), 2u);
  counter.restart();
  EXPECT_EQ(counter.count(3), 3u);
  EXPECT_EQ(counter.lost(), 0u);
}

TEST(FrameCounter, ACountThatStandsStillOrGoesBackwardsIsCountedFor) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(100), 100u);
  EXPECT_EQ(counter.count(100), 101u);
  EXPECT_EQ(counter.count(102), 102u) << "and it may come right again";
  EXPECT_EQ(counter.count(5), 103u);
  EXPECT_EQ(counter.count(104), 104u) << "this too";
  EXPECT_EQ(counter.lost(), 0u);
}

TEST(FrameCounter, AGapAfterASmallStepBackIsCountedWhole) {
  FrameCounter by_two;
  for (const std::uint32_t count : {10u, 8u, 9u, 15u}) by_two.count(count);
  EXPECT_EQ(by_two.lost(), 5u);
  FrameCounter restarted;
  for (const std::uint32_t count : {0u, 1u, 2u, 3u, 0u, 1u, 7u}) restarted.count(count);
  EXPECT_EQ(restarted.lost(), 5u);
  FrameCounter behind;
  behind.count(20);
  behind.count(21, 4);
  for (const std::uint32_t count : {0u, 4u}) behind.count(count);
  EXPECT_EQ(behind.lost(), 6u) << "what it was behind by is over with the step back";
}

TEST(FrameCounter, GapsAreSeenAfterTheCountWentBackwards) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(100), 100u);
  EXPECT_EQ(counter.count(5), 101u);
  EXPECT_EQ(counter.count(6), 102u);
  EXPECT_EQ(counter.count(9), 105u);
  EXPECT_EQ(counter.count(10), 106u);
  EXPECT_EQ(counter.count(12, 1), 108u);
  EXPECT_EQ(counter.lost(), 3u);
}

TEST(FrameCounter, NothingIsLostTwice) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(1), 1u);
  EXPECT_EQ(counter.count(2, 3), 4u) << "the stamps tell first";
  EXPECT_EQ(counter.count(5, 1), 5u) << "and the count with the next frame";
  EXPECT_EQ(counter.lost(), 2u);
}

TEST(FrameCounter, TheCountMayOverflow) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(0xffffffffu), 0xffffffffu);
  EXPECT_EQ(counter.count(1), 1u);
  EXPECT_EQ(counter.lost(), 1u);
}

TEST(FrameCounter, TimeTellsOfLossesThatTheCountDoesNot) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(1, 9), 1u);  // the first has none before it
  EXPECT_EQ(counter.count(2, 4), 5u);
  EXPECT_EQ(counter.count(3, 1), 6u);  // and is behind from now on
  EXPECT_EQ(counter.count(9, 2), 9u);  // the count tells of more
  EXPECT_EQ(counter.lost(), 5u);
}

}  // namespace
}  // namespace touchline::hal
