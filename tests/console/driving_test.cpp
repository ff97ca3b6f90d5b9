#include "firmware/console/driving.h"

#include <gtest/gtest.h>

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

constexpr Instant kBegin{std::chrono::hours(1)};

class DrivingTest : public ::testing::Test {
 protected:
  Driving driving{{0, 3}};
};

TEST_F(DrivingTest, EverybodyStopsAndOnlyTheDriverStarts) {
  EXPECT_FALSE(driving.is_stopped());
  driving.stop();
  EXPECT_TRUE(driving.input().stop);
  EXPECT_TRUE(driving.take_change());
  EXPECT_EQ(driving.start(1, 1).code(), ErrorCode::kPermission);
  driving.take(1, kBegin);
  EXPECT_EQ(driving.start(2, 1).code(), ErrorCode::kPermission);
  EXPECT_TRUE(driving.input().stop);
  EXPECT_TRUE(driving.start(1, 1).ok());
  EXPECT_FALSE(driving.input().stop);
  EXPECT_TRUE(driving.take_change());
  EXPECT_FALSE(driving.take_change());
}

TEST_F(DrivingTest, SaysWhetherTheEndOfASetupOrAPersonStoppedTheRobots) {
  driving.take(1, kBegin);
  driving.stop_after_setup();
  EXPECT_TRUE(driving.input().stop);
  EXPECT_TRUE(driving.input().setup_ended);
  EXPECT_TRUE(driving.take_change());
  driving.stop();
  EXPECT_FALSE(driving.input().setup_ended) << "now somebody has";
  EXPECT_TRUE(driving.take_change());
  driving.stop_after_setup();
  EXPECT_FALSE(driving.input().setup_ended) << "and that stop holds";
  EXPECT_TRUE(driving.start(1, driving.stop_number()).ok());
  driving.stop_after_setup();
  EXPECT_TRUE(driving.leave(1));
  EXPECT_FALSE(driving.input().setup_ended) << "the driver has gone";
}

TEST_F(DrivingTest, AStartNamesTheStopThatItEnds) {
  driving.take(1, kBegin);
  driving.stop();
  driving.stop();  // another client stops while the robots stand already
  EXPECT_EQ(driving.start(1, 1).code(), ErrorCode::kInconsistent);
  EXPECT_TRUE(driving.is_stopped());
  EXPECT_TRUE(driving.start(1, 2).ok());
  EXPECT_FALSE(driving.is_stopped());
  EXPECT_TRUE(driving.set_held(1, true));
  EXPECT_FALSE(driving.set_held(1, true));
  EXPECT_TRUE(driving.is_stopped()) << "by the loop";
  EXPECT_EQ(driving.start(1, 2).code(), ErrorCode::kInconsistent);
  ASSERT_TRUE(driving.start(1, 3).ok());
  EXPECT_EQ(driving.input().starts, 2U);
  EXPECT_EQ(driving.input().start_number, 1U) << "for the loop";
}

TEST_F(DrivingTest, OnlyTheDriverDrivesRobotsThatExist) {
  EXPECT_EQ(driving.drive(1, 3, {0.5f, 1.0f}, kBegin).code(), ErrorCode::kPermission);
  driving.take(1, kBegin);
  EXPECT_EQ(driving.drive(1, 4, {0.5f, 1.0f}, kBegin).code(), ErrorCode::kNotFound);
  ASSERT_TRUE(driving.drive(1, 3, {0.5f, 1.0f}, kBegin).ok());
  ASSERT_TRUE(driving.drive(1, 3, {0.25f, 1.0f}, kBegin + 1ms).ok());
  ASSERT_EQ(driving.input().commands.size(), 1U);
  EXPECT_EQ(driving.input().commands[0].twist.v_mps, 0.25f);
  EXPECT_EQ(driving.input().commands[0].received, kBegin + 1ms);
  driving.take(2, kBegin);
  EXPECT_EQ(driving.drive(1, 3, {}, kBegin).code(), ErrorCode::kPermission) << "the lock was taken over";
  EXPECT_EQ(driving.input().commands.size(), 1U) << "the robot does not begin to play by itself";
  EXPECT_TRUE(driving.give_back(2, 3).ok());
  EXPECT_TRUE(driving.input().commands.empty());
  EXPECT_EQ(driving.give_back(2, 3).code(), ErrorCode::kNotFound);
}

TEST_F(DrivingTest, ACommandFromBeforeAStopMovesNothingAfterIt) {
  driving.take(1, kBegin);
  ASSERT_TRUE(driving.drive(1, 3, {0.5f, 1.0f}, kBegin).ok());
  driving.stop();
  ASSERT_TRUE(driving.start(1, driving.stop_number()).ok());
  ASSERT_EQ(driving.input().commands.size(), 1U);
  EXPECT_EQ(driving.input().commands[0].twist.v_mps, 0.0f);
  EXPECT_EQ(driving.input().commands[0].twist.w_radps, 0.0f);
}

TEST_F(DrivingTest, ADriverWhoLeavesStopsTheRobotsAndOthersDoNot) {
  driving.take(1, kBegin);
  EXPECT_FALSE(driving.leave(2));
  EXPECT_FALSE(driving.is_stopped());
  EXPECT_TRUE(driving.leave(1));
  EXPECT_TRUE(driving.is_stopped());
  EXPECT_FALSE(driving.driver().has_value());
}

TEST_F(DrivingTest, ADriverWhoGivesUpStopsNothing) {
  driving.take(1, kBegin);
  ASSERT_TRUE(driving.drive(1, 0, {0.5f, 0.0f}, kBegin).ok());
  EXPECT_EQ(driving.release(2).code(), ErrorCode::kPermission);
  EXPECT_TRUE(driving.release(1).ok());
  EXPECT_FALSE(driving.is_stopped());
  EXPECT_TRUE(driving.input().commands.empty());
  EXPECT_FALSE(driving.is_silent(kBegin + 10s)) << "nobody drives";
  EXPECT_FALSE(driving.input().driver_heard.has_value());
}

TEST_F(DrivingTest, TheLoopIsToldWhenTheDriverWasHeard) {
  driving.take(1, kBegin);
  EXPECT_TRUE(driving.take_change());
  EXPECT_EQ(driving.input().driver_heard, kBegin);
  driving.hear(2, kBegin + 1s);  // another client
  EXPECT_FALSE(driving.take_change());
  driving.hear(1, kBegin + 1s);
  EXPECT_TRUE(driving.take_change());
  EXPECT_EQ(driving.input().driver_heard, kBegin + 1s);
  EXPECT_FALSE(driving.is_silent(kBegin + 2s));
  EXPECT_TRUE(driving.is_silent(kBegin + 2s + 1us));
}

}  // namespace
}  // namespace touchline::console
