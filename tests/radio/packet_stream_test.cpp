#include "core/radio/packet_stream.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/radio/noisy_line.h"
#include "tests/radio/touchline_packets.h"

namespace touchline {
namespace {

Packet packet_of(std::size_t robots, std::uint8_t sequence, TeamNumber team = kNoTeamNumber) {
  Commands commands;
  commands.stop = false;
  for (std::size_t i = 0; i < robots; ++i) {
    // 0x4C54 mm/s: a speed that looks like the start of a packet.
    commands.robots.push_back({static_cast<RobotId>(i), {}, {19.540f, 0.1f * static_cast<float>(i)}});
  }
  Packet packet;
  EXPECT_TRUE(encode(commands, sequence, packet, team).ok());
  return packet;
}

std::vector<std::uint8_t> sequences_in(CommandStream& stream, const std::vector<std::byte>& bytes) {
  std::vector<std::uint8_t> found;
  Commands commands;
  std::uint8_t sequence = 0;
  for (const std::byte byte : bytes) {
    stream.push(byte);
    while (stream.next(commands, sequence)) found.push_back(sequence);
  }
  return found;
}

void append(std::vector<std::byte>& bytes, const Packet& packet) {
  bytes.insert(bytes.end(), packet.begin(), packet.end());
}

TEST(PacketStream, FindsAllPacketsOnAnErrorFreeLine) {
  std::vector<std::byte> bytes;
  std::vector<std::uint8_t> expected;
  for (std::size_t i = 0; i < 300; ++i) {
    append(bytes, packet_of(i % 12, static_cast<std::uint8_t>(i)));
    expected.push_back(static_cast<std::uint8_t>(i));
  }
  CommandStream stream;
  EXPECT_EQ(sequences_in(stream, bytes), expected);
  EXPECT_EQ(stream.skipped_bytes(), 0u);
}

TEST(PacketStream, ReturnsThePacketsOfItsTeamAmongThoseOfOthers) {
  std::vector<std::byte> bytes;
  std::vector<std::uint8_t> of_team[3];
  constexpr std::array<TeamNumber, 3> kTeams{3, 7, 0x4C};
  for (std::size_t i = 0; i < 300; ++i) {
    append(bytes, packet_of(i % 12, static_cast<std::uint8_t>(i), kTeams[i % 3]));
    of_team[i % 3].push_back(static_cast<std::uint8_t>(i));
  }
  for (std::size_t team = 0; team < 3; ++team) {
    CommandStream stream(kTeams[team]);
    EXPECT_EQ(sequences_in(stream, bytes), of_team[team]);
    EXPECT_EQ(stream.skipped_bytes(), 0u);
    EXPECT_EQ(stream.foreign_packets(), 200u);
  }
}

TEST(PacketStream, ReportsAPacketAtItsLastByte) {
  const Packet packet = packet_of(5, 9);
  CommandStream stream;
  Commands commands;
  std::uint8_t sequence = 0;
  for (std::size_t i = 0; i < packet.size(); ++i) {
    stream.push(packet[i]);
    EXPECT_EQ(stream.next(commands, sequence), i + 1 == packet.size());
  }
  EXPECT_EQ(commands.robots.size(), 5u);
}

TEST(PacketStream, LosesOnlyTheTruncatedPacket) {
  const Packet before = packet_of(5, 1), cut = packet_of(5, 2), after = packet_of(5, 3);
  for (std::size_t begin = 0; begin < cut.size(); ++begin) {
    for (const std::size_t gone : {std::size_t{1}, std::size_t{4}, cut.size() - begin}) {
      if (begin + gone > cut.size()) continue;
      std::vector<std::byte> bytes;
      append(bytes, before);
      for (std::size_t i = 0; i < cut.size(); ++i) {
        if (i < begin || i >= begin + gone) bytes.push_back(cut[i]);
      }
      append(bytes, after);
      CommandStream stream;
      EXPECT_EQ(sequences_in(stream, bytes), (std::vector<std::uint8_t>{1, 3})) << begin << " " << gone;
      EXPECT_EQ(stream.skipped_bytes(), cut.size() - gone);
    }
  }
}

TEST(PacketStream, FindsShortPacketsWithinTheLengthOfACorruptCount) {
  std::vector<std::byte> bytes;
  Packet damaged = packet_of(1, 1);
  damaged[5] = std::byte{11};
  append(bytes, damaged);
  std::vector<std::uint8_t> expected;
  for (std::uint8_t i = 2; i < 12; ++i) {
    append(bytes, packet_of(0, i));
    expected.push_back(i);
  }
  CommandStream stream;
  EXPECT_EQ(sequences_in(stream, bytes), expected);
  EXPECT_EQ(stream.skipped_bytes(), damaged.size());
}

TEST(PacketStream, RestartsAfterAPause) {
  Packet first = packet_of(5, 1);
  first.resize(20);
  CommandStream stream;
  EXPECT_TRUE(sequences_in(stream, {first.begin(), first.end()}).empty());
  stream.reset();
  const Packet second = packet_of(2, 2);
  EXPECT_EQ(sequences_in(stream, {second.begin(), second.end()}), (std::vector<std::uint8_t>{2}));
  EXPECT_EQ(stream.skipped_bytes(), 20u);
}

TEST(PacketStream, DropsTheOldestBytesIfNextIsNotCalled) {
  CommandStream stream;
  for (std::size_t i = 0; i < 1000; ++i) stream.push(kPacketMagic0);
  const Packet packet = packet_of(3, 77);
  for (const std::byte byte : packet) stream.push(byte);
  Commands commands;
  std::uint8_t sequence = 0;
  ASSERT_TRUE(stream.next(commands, sequence));
  EXPECT_EQ(sequence, 77);
  EXPECT_EQ(stream.skipped_bytes(), 1000u);
}

// A noisy line that loses, inserts and corrupts bytes. Every reported packet was sent, and reception recovers
// immediately.
TEST(PacketStream, ReportsOnlySentPacketsOnANoisyLine) {
  std::mt19937 random(3);
  testing::NoisyLine line(random);
  int whole = 0;
  constexpr int kSent = 5000;
  for (int i = 0; i < kSent; ++i) {
    const Packet packet = packet_of(static_cast<std::size_t>(i % 12), static_cast<std::uint8_t>(i));
    whole += line.send({packet.data(), packet.size()}) ? 1 : 0;
  }
  CommandStream stream;
  Commands commands;
  std::uint8_t sequence = 0;
  int found = 0, wrong = 0;
  for (const std::byte b : line.received()) {
    stream.push(b);
    while (stream.next(commands, sequence)) {
      ++found;
      for (const RobotCommand& robot : commands.robots) {
        if (std::abs(robot.wheels.left_mps - 19.540f) > 1e-4f) ++wrong;
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  // A byte inserted after the last one leaves the packet intact, so slightly more packets are found than counted as
  // intact.
  EXPECT_GE(found, whole);
  EXPECT_LE(found, whole + kSent / 50);
  EXPECT_GT(whole, 1500);
}

TEST(SequenceFilter, IgnoresRepeatedAndReorderedPackets) {
  SequenceFilter filter;
  EXPECT_TRUE(filter.obey(250, false)) << "the first one is always new";
  EXPECT_FALSE(filter.obey(250, false));
  EXPECT_TRUE(filter.obey(251, false));
  EXPECT_FALSE(filter.obey(250, false));
  EXPECT_TRUE(filter.obey(3, false)) << "across the wrap-around";
  EXPECT_FALSE(filter.obey(255, false));
  EXPECT_TRUE(filter.obey(130, false)) << "127 steps ahead";
  EXPECT_FALSE(filter.obey(2, false)) << "128 steps ahead equal 128 steps behind";
}

TEST(SequenceFilter, AlwaysObeysAStop) {
  SequenceFilter filter;
  EXPECT_TRUE(filter.obey(10, false));
  EXPECT_TRUE(filter.obey(10, true));
  EXPECT_TRUE(filter.obey(9, true));
  EXPECT_FALSE(filter.obey(10, false)) << "an old stop must not make old packets new";
  filter.reset();
  EXPECT_TRUE(filter.obey(10, false));
}

}  // namespace
}  // namespace touchline
