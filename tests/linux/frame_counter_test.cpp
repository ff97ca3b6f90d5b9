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

TEST(FrameCounter, ARepeatedOrDecreasingSequenceNumberIsNotALoss) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(100), 100u);
  EXPECT_EQ(counter.count(100), 101u);
  EXPECT_EQ(counter.count(102), 102u) << "the driver's numbers apply again";
  EXPECT_EQ(counter.count(5), 103u);
  EXPECT_EQ(counter.count(104), 104u) << "here too";
  EXPECT_EQ(counter.lost(), 0u);
}

TEST(FrameCounter, AGapAfterADecreaseIsCountedCompletely) {
  FrameCounter decreased_by_two;
  for (const std::uint32_t count : {10u, 8u, 9u, 15u}) decreased_by_two.count(count);
  EXPECT_EQ(decreased_by_two.lost(), 5u);
  FrameCounter restarted;
  for (const std::uint32_t count : {0u, 1u, 2u, 3u, 0u, 1u, 7u}) restarted.count(count);
  EXPECT_EQ(restarted.lost(), 5u);
  FrameCounter behind;
  behind.count(20);
  behind.count(21, 4);
  for (const std::uint32_t count : {0u, 4u}) behind.count(count);
  EXPECT_EQ(behind.lost(), 6u) << "a decrease clears the surplus";
}

TEST(FrameCounter, GapsAreCountedAfterADecrease) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(100), 100u);
  EXPECT_EQ(counter.count(5), 101u);
  EXPECT_EQ(counter.count(6), 102u);
  EXPECT_EQ(counter.count(9), 105u);
  EXPECT_EQ(counter.count(10), 106u);
  EXPECT_EQ(counter.count(12, 1), 108u);
  EXPECT_EQ(counter.lost(), 3u);
}

TEST(FrameCounter, NoFrameIsCountedAsLostTwice) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(1), 1u);
  EXPECT_EQ(counter.count(2, 3), 4u) << "seen first in the time stamps";
  EXPECT_EQ(counter.count(5, 1), 5u) << "then in the driver's numbers";
  EXPECT_EQ(counter.lost(), 2u);
}

TEST(FrameCounter, TheSequenceNumberMayWrapAround) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(0xffffffffu), 0xffffffffu);
  EXPECT_EQ(counter.count(1), 1u);
  EXPECT_EQ(counter.lost(), 1u);
}

TEST(FrameCounter, TimeStampsRevealLossesThatTheDriversNumbersMiss) {
  FrameCounter counter;
  EXPECT_EQ(counter.count(1, 9), 1u);  // no frame before it
  EXPECT_EQ(counter.count(2, 4), 5u);
  EXPECT_EQ(counter.count(3, 1), 6u);  // the driver's number is behind from now on
  EXPECT_EQ(counter.count(9, 2), 9u);  // the driver's numbers show more
  EXPECT_EQ(counter.lost(), 5u);
}

}  // namespace
}  // namespace touchline::hal
