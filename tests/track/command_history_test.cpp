#include "core/track/command_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

Commands drive(RobotId id, float v, float w = 0.0f) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({id, {v, w}, {}});
  return commands;
}

TEST(CommandHistory, KnowsNothingBeforeTheFirstCommands) {
  CommandHistory history;
  EXPECT_FALSE(history.at(at(1.0), 0).known);
  history.add(drive(0, 1.0f), at(2.0));
  EXPECT_FALSE(history.at(at(1.999), 0).known);
  EXPECT_TRUE(history.at(at(2.0), 0).known);
}

TEST(CommandHistory, GivesTheActiveCommand) {
  CommandHistory history;
  history.add(drive(3, 0.1f), at(1.0));
  history.add(drive(3, 0.2f), at(1.1));
  history.add(drive(3, 0.3f), at(1.2));
  EXPECT_FLOAT_EQ(history.at(at(1.05), 3).twist.v_mps, 0.1f);
  EXPECT_FLOAT_EQ(history.at(at(1.1), 3).twist.v_mps, 0.2f);
  EXPECT_FLOAT_EQ(history.at(at(9.0), 3).twist.v_mps, 0.3f);
  EXPECT_EQ(history.next_change(at(1.05), at(5.0), 3), at(1.1));
  EXPECT_EQ(history.next_change(at(1.1), at(5.0), 3), at(1.2));
  EXPECT_EQ(history.next_change(at(1.1), at(1.15), 3), at(1.15));
  EXPECT_EQ(history.next_change(at(1.2), at(5.0), 3), at(5.0));
}

TEST(CommandHistory, ShiftsTheCommandsOfRobotsThatGetTheirPacketsLater) {
  CommandHistory history;
  Commands both = drive(3, 0.1f);
  both.robots.push_back({4, {0.5f, 0.0f}, {}});
  history.add(both, at(1.0));
  history.add(Commands{}, at(1.1));
  history.set_lateness(4, from_seconds(0.03));
  EXPECT_FALSE(history.at(at(1.02), 4).known);
  EXPECT_FLOAT_EQ(history.at(at(1.02), 3).twist.v_mps, 0.1f);
  EXPECT_FLOAT_EQ(history.at(at(1.12), 4).twist.v_mps, 0.5f) << "the stop arrives at 1.13 s";
  EXPECT_FLOAT_EQ(history.at(at(1.12), 3).twist.v_mps, 0.0f);
  EXPECT_EQ(history.next_change(at(1.05), at(5.0), 4), at(1.13));
  history.forget_before(at(1.12));
  EXPECT_FLOAT_EQ(history.at(at(1.12), 4).twist.v_mps, 0.5f) << "it still acts on this robot";
}

TEST(CommandHistory, GivesZeroForRobotsThatAreNotListed) {
  CommandHistory history;
  history.add(drive(3, 0.5f), at(1.0));
  EXPECT_TRUE(history.at(at(1.0), 4).known);
  EXPECT_FLOAT_EQ(history.at(at(1.0), 4).twist.v_mps, 0.0f);
}

TEST(CommandHistory, AppliesAStopToAllRobots) {
  CommandHistory history;
  Commands commands = drive(3, 0.5f);
  commands.stop = true;
  history.add(commands, at(1.0));
  EXPECT_TRUE(history.at(at(1.0), 3).known);
  EXPECT_FLOAT_EQ(history.at(at(1.0), 3).twist.v_mps, 0.0f);
}

TEST(CommandHistory, ReplacesPendingCommandsByANewerPacket) {
  CommandHistory history;
  history.add(drive(0, 0.1f), at(1.00));
  history.add(drive(0, 0.2f), at(1.10));
  history.add(drive(0, 0.3f), at(1.20));
  history.add(drive(0, 0.4f), at(1.05));  // the delay has become shorter
  EXPECT_FLOAT_EQ(history.at(at(1.04), 0).twist.v_mps, 0.1f);
  EXPECT_FLOAT_EQ(history.at(at(1.30), 0).twist.v_mps, 0.4f);
  EXPECT_EQ(history.next_change(at(1.05), at(5.0), 0), at(5.0));
}

TEST(CommandHistory, KeepsTheActiveCommandWhenForgetting) {
  CommandHistory history;
  for (int i = 0; i < 10; ++i) history.add(drive(0, 0.1f * static_cast<float>(i)), at(1.0 + 0.1 * i));
  history.forget_before(at(1.55));
  EXPECT_FLOAT_EQ(history.at(at(1.55), 0).twist.v_mps, 0.5f);
  EXPECT_FLOAT_EQ(history.at(at(1.95), 0).twist.v_mps, 0.9f);
  EXPECT_FALSE(history.at(at(1.2), 0).known);
}

TEST(CommandHistory, CountsDroppedCommands) {
  CommandHistory history;
  for (int i = 0; i < 256; ++i) history.add(drive(0, static_cast<float>(i)), at(1.0 + 0.001 * i));
  EXPECT_EQ(history.dropped(), 0u);
  history.add(drive(0, 1.5f), at(2.0));
  EXPECT_EQ(history.dropped(), 1u);
  EXPECT_FALSE(history.at(at(1.0), 0).known);
  EXPECT_FLOAT_EQ(history.at(at(1.001), 0).twist.v_mps, 1.0f);
  EXPECT_FLOAT_EQ(history.at(at(2.0), 0).twist.v_mps, 1.5f);
}

TEST(CommandHistory, LimitsAbsurdVelocities) {
  CommandHistory history;
  history.add(drive(0, std::nanf(""), std::numeric_limits<float>::infinity()), at(1.0));
  const Twist twist = history.at(at(1.0), 0).twist;
  EXPECT_EQ(twist.v_mps, 0.0f);
  EXPECT_EQ(twist.w_radps, 200.0f);
}

}  // namespace
}  // namespace touchline
