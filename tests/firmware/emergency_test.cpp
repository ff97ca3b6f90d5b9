// Emergency stop: pulled, released, bouncing, unreadable.
#include <algorithm>

#include "tests/firmware/loop_fixture.h"

namespace touchline::testing {
namespace {

constexpr double kFrame = 0.02, kRelease = 0.1;

TEST_F(LoopTest, EmergencyStopHaltsFromTheNextPacket) {
  gpio.pull(1.0, 2.0);
  start();
  run_until(3.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  EXPECT_TRUE(all_stop(1.001, 2.0));
  EXPECT_LE(packets(1.001, 2.0).front().at_s, 1.0 + kFrame);
  EXPECT_TRUE(all_stop(2.0, 2.0 + kRelease - kFrame));
  EXPECT_FALSE(all_stop(2.0 + kRelease + 2 * kFrame, 3.0));
  EXPECT_EQ(loop->statistics().frames, 150U) << "frames are still processed";
}

TEST_F(LoopTest, EmergencyStopDoesNotWaitForTheNextFrame) {
  gpio.pull(0.999, 2.0);
  start();
  run_until(1.5);
  const auto sent = packets(0.999, 1.5);
  const auto first = std::find_if(sent.begin(), sent.end(), [](const SentPacket& packet) { return packet.stop; });
  ASSERT_NE(first, sent.end());
  EXPECT_NEAR(first->at_s, 1.0, 1e-6) << "read after the frame of 1.00 s; the next frame comes at 1.02 s";
}

TEST_F(LoopTest, EmergencyStopDuringTheWaitForAFrameStopsWithThatFrame) {
  gpio.pull(1.005, 2.0);
  start();
  run_until(1.5);
  const auto at_frame = packets(1.005, 1.03);
  ASSERT_EQ(at_frame.size(), 1U) << "the packet with speeds is not sent";
  EXPECT_NEAR(at_frame[0].at_s, 1.02, 1e-6);
  EXPECT_TRUE(all_stop(1.005, 1.5));
  for (std::size_t i = 1; i < radio.sent.size(); ++i) {
    EXPECT_EQ(radio.sent[i].sequence, static_cast<std::uint8_t>(radio.sent[i - 1].sequence + 1));
  }
}

TEST_F(LoopTest, ARevokedPacketIsAStopInTheTrace) {
  camera.show_robot();
  gpio.pull(1.005, 2.0);
  std::vector<Commands> seen;
  start({[](void* context, const StepTrace& trace, const StepTiming&) {
           static_cast<std::vector<Commands>*>(context)->push_back(trace.commands);
         },
         &seen});
  run_until(1.5);
  ASSERT_EQ(seen.size(), 75U);
  const Commands &driven = seen[49], &revoked = seen[50], &halted = seen[51];
  EXPECT_FALSE(driven.stop) << "the frame of 1.00 s";
  ASSERT_EQ(driven.robots.size(), 1U);
  EXPECT_NE(driven.robots[0].wheels.left_mps, driven.robots[0].wheels.right_mps);
  for (const Commands* const stopped : {&revoked, &halted}) {
    EXPECT_TRUE(stopped->stop);
    ASSERT_EQ(stopped->robots.size(), 1U) << "the robot is listed as in the packet";
    EXPECT_EQ(stopped->robots[0].id, driven.robots[0].id);
    EXPECT_EQ(stopped->robots[0].twist.v_mps, 0.0F);
    EXPECT_EQ(stopped->robots[0].twist.w_radps, 0.0F);
    EXPECT_EQ(stopped->robots[0].wheels.left_mps, 0.0F);
    EXPECT_EQ(stopped->robots[0].wheels.right_mps, 0.0F);
  }
}

TEST_F(LoopTest, EmergencyStopWorksWithoutFrames) {
  gpio.pull(1.0, 2.0);
  camera.add({1.0, 1.18, ErrorCode::kTimeout});
  start();
  run_until(1.5);
  EXPECT_LE(packets(1.001, 1.5).front().at_s, 1.0 + 0.051);
  EXPECT_TRUE(all_stop(1.001, 1.5));
}

TEST_F(LoopTest, ABouncingContactDoesNotMoveRobots) {
  for (int i = 0; i < 10; ++i) gpio.pull(1.0 + 0.06 * i, 1.03 + 0.06 * i);
  start();
  run_until(3.0);
  EXPECT_TRUE(all_stop(1.001, 1.57 + kRelease - kFrame));
  EXPECT_FALSE(all_stop(1.57 + kRelease + 2 * kFrame, 3.0));
}

TEST_F(LoopTest, RobotsCanWaitForANewStart) {
  settings.faults.resume_after_emergency = false;
  gpio.pull(1.0, 1.5);
  start();
  run_until(10.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  EXPECT_TRUE(all_stop(1.001, 10.0));
}

TEST_F(LoopTest, AnUnreadableLineCountsAsPulled) {
  gpio.add({1.0, 1.7, ErrorCode::kIo});
  start();
  run_until(4.0);
  EXPECT_TRUE(all_stop(1.001, 1.5));
  EXPECT_EQ(loop->statistics().reopened[2], 2U) << "at 1.5 s without success, and at 2 s";
  EXPECT_FALSE(all_stop(2.2, 4.0));
  std::uint32_t halt = 0;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kHalt) halt = static_cast<std::uint8_t>(halt | report.halt.halt);
  }
  EXPECT_EQ(halt, kHaltUnreadableLine | kHaltEmergency) << "until the line has been inactive for a tenth of a second";
}

TEST_F(LoopTest, AnUnreadableLineNeedsANewStartIfAPulledOneDoes) {
  settings.faults.resume_after_emergency = false;
  gpio.add({1.0, 1.7, ErrorCode::kIo});
  gpio.press(5.0);
  start();
  run_until(7.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  EXPECT_TRUE(all_stop(1.001, 5.0)) << "readable again from 2 s";
  EXPECT_FALSE(all_stop(5.04, 7.0));
}

TEST_F(LoopTest, HaltsAreReportedWithTheirReasons) {
  gpio.pull(1.0, 1.5);
  camera.add({2.0, 2.5, ErrorCode::kTimeout});
  start();
  run_until(3.0);
  std::vector<std::uint32_t> halts;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kHalt) halts.push_back(report.halt.halt);
  }
  EXPECT_EQ(halts, (std::vector<std::uint32_t>{kHaltNone, kHaltEmergency, kHaltNone, kHaltNoFrames, kHaltNone}));
}

}  // namespace
}  // namespace touchline::testing
