#include "hal/packet_slot.h"

#include <gtest/gtest.h>

#include <vector>

namespace touchline::hal {
namespace {

/// A line that is busy until free() is called, and whose driver takes at most `room` bytes of a packet at once.
class Line final : public ByteLine {
 public:
  Result<std::size_t> unsent_bytes() override { return unsent_; }
  Result<std::size_t> write(std::span<const std::byte> bytes) override {
    const std::size_t taken = std::min(bytes.size(), room);
    for (std::size_t i = 0; i < taken; ++i) sent.push_back(std::to_integer<int>(bytes[i]));
    unsent_ += taken;
    return taken;
  }
  void free() { unsent_ = 0; }

  std::size_t room = kMaxPacketBytes;
  std::vector<int> sent;

 private:
  std::size_t unsent_ = 0;
};

class PacketSlotTest : public ::testing::Test {
 protected:
  Result<void> send(int value, std::size_t receiver, std::size_t bytes = 1) {
    Packet packet;
    for (std::size_t i = 0; i < bytes; ++i) packet.push_back(static_cast<std::byte>(value));
    return slot.send(packet, receiver, line);
  }
  void serve_all() {
    while (slot.bytes() > 0) {
      line.free();
      ASSERT_TRUE(slot.serve(line).ok());
    }
  }
  Line line;
  PacketSlot slot;
};

TEST_F(PacketSlotTest, ANewerPacketReplacesOnlyThatOfItsReceiver) {
  ASSERT_TRUE(send(10, 0).ok()) << "the line is free";
  for (int robot = 1; robot <= 3; ++robot) ASSERT_TRUE(send(10 + robot, static_cast<std::size_t>(robot)).ok());
  EXPECT_EQ(send(22, 2).code(), ErrorCode::kBusy);
  EXPECT_EQ(slot.bytes(), 3U);
  serve_all();
  EXPECT_EQ(line.sent, (std::vector{10, 11, 22, 13}));
}

TEST_F(PacketSlotTest, ALineForAThirdOfThePacketsServesAllReceiversAlike) {
  std::vector<int> served(kMaxRobotsPerTeam, 0), newest(kMaxRobotsPerTeam, -1);
  std::size_t seen = 0;
  for (int frame = 0; frame < 30; ++frame) {
    for (std::size_t robot = 0; robot < kMaxRobotsPerTeam; ++robot) {
      Packet packet;
      packet.push_back(static_cast<std::byte>(robot));
      packet.push_back(static_cast<std::byte>(frame));
      static_cast<void>(slot.send(packet, robot, line));
    }
    for (std::size_t i = 0; i < kMaxRobotsPerTeam / 3; ++i) {
      line.free();
      ASSERT_TRUE(slot.serve(line).ok());
      for (; seen + 1 < line.sent.size(); seen += 2) {
        const auto robot = static_cast<std::size_t>(line.sent[seen]);
        ++served[robot];
        EXPECT_GE(line.sent[seen + 1], frame - 1) << "robot " << robot << ": an old packet";
        EXPECT_GT(line.sent[seen + 1], newest[robot]);
        newest[robot] = line.sent[seen + 1];
      }
    }
  }
  for (std::size_t robot = 0; robot < kMaxRobotsPerTeam; ++robot) {
    EXPECT_GE(served[robot], 8) << robot;
    EXPECT_LE(served[robot], 9) << robot;
  }
}

TEST_F(PacketSlotTest, APacketForAllReplacesWhatWaitsForSingleRobots) {
  ASSERT_TRUE(send(1, 0).ok());
  ASSERT_TRUE(send(2, 1).ok());
  ASSERT_TRUE(send(3, 2).ok());
  EXPECT_EQ(send(99, kAllRobots).code(), ErrorCode::kBusy);
  ASSERT_TRUE(send(4, 1).ok()) << "it is newer than the packet for all";
  serve_all();
  EXPECT_EQ(line.sent, (std::vector{1, 99, 4}));
}

TEST_F(PacketSlotTest, APacketThatTheDriverTookInPartIsCompletedFirst) {
  line.room = 2;
  ASSERT_TRUE(send(1, 0, 5).ok());
  ASSERT_TRUE(send(2, 1, 2).ok());
  ASSERT_TRUE(send(3, 0, 2).ok()) << "the older packet of robot 0 no longer waits";
  EXPECT_EQ(slot.bytes(), 4U) << "the first packet is complete by now";
  serve_all();
  EXPECT_EQ(line.sent, (std::vector{1, 1, 1, 1, 1, 2, 2, 3, 3}));
  EXPECT_EQ(slot.split_packets(), 1U);
}

TEST_F(PacketSlotTest, ClearDropsAllPackets) {
  for (std::size_t robot = 0; robot < kMaxRobotsPerTeam; ++robot) ASSERT_TRUE(send(1, robot).ok());
  slot.clear();
  EXPECT_EQ(slot.bytes(), 0U);
  line.free();
  ASSERT_TRUE(slot.serve(line).ok());
  EXPECT_EQ(line.sent.size(), 1U);
  EXPECT_TRUE(send(2, 3).ok()) << "nothing is replaced";
}

}  // namespace
}  // namespace touchline::hal
