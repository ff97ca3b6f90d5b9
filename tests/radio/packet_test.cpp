#include "core/radio/packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string_view>
#include <vector>

#include "tests/radio/touchline_packets.h"

namespace touchline {
namespace {

RobotCommand robot(RobotId id, float left, float right) { return {id, {}, {left, right}}; }

Commands sample_commands() {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back(robot(0, 0.5f, -0.25f));
  commands.robots.push_back(robot(3, 1.234f, 1.234f));
  return commands;
}

TEST(Crc16, HasTheCatalogsCheckValue) {
  constexpr std::string_view kDigits = "123456789";
  EXPECT_EQ(checksum(CheckKind::kCrc16Ccitt, std::as_bytes(std::span(kDigits.data(), kDigits.size()))), 0x29B1);
  EXPECT_EQ(checksum(CheckKind::kCrc16Ccitt, {}), 0xFFFF);
}

TEST(Packet, IsReadBackAsWritten) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> step(-32767, 32767);
  for (std::size_t count = 0; count <= kMaxRobotsPerTeam; ++count) {
    Commands sent;
    sent.stop = false;
    for (std::size_t i = 0; i < count; ++i) {
      const auto id = static_cast<RobotId>(127 - i);
      sent.robots.push_back(
          robot(id, static_cast<float>(step(random)) * kWheelResolutionMps, static_cast<float>(step(random)) * 1e-3f));
    }
    Packet packet;
    ASSERT_TRUE(encode(sent, static_cast<std::uint8_t>(250 + count), packet).ok());
    EXPECT_EQ(packet.size(), packet_bytes(count));
    Commands read;
    std::uint8_t sequence = 0;
    ASSERT_TRUE(decode(bytes_of(packet), read, sequence).ok());
    EXPECT_EQ(sequence, static_cast<std::uint8_t>(250 + count));
    EXPECT_FALSE(read.stop);
    ASSERT_EQ(read.robots.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(read.robots[i].id, sent.robots[i].id);
      EXPECT_NEAR(read.robots[i].wheels.left_mps, sent.robots[i].wheels.left_mps, 1e-5);
      EXPECT_NEAR(read.robots[i].wheels.right_mps, sent.robots[i].wheels.right_mps, 1e-5);
    }
  }
}

TEST(Packet, RoundsToTheNearestStepAndSaturates) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<float, float>> sent_and_read = {
      {0.0004f, 0.0f},      {0.0006f, 0.001f},      {-0.0006f, -0.001f}, {32.9f, 32.767f},     {-32.9f, -32.767f},
      {kInfinity, 32.767f}, {-kInfinity, -32.767f}, {1e30f, 32.767f},    {std::nanf(""), 0.0f}};
  for (const auto& [sent, read] : sent_and_read) {
    Commands commands;
    commands.stop = false;
    commands.robots.push_back(robot(1, sent, -sent));
    Packet packet;
    ASSERT_TRUE(encode(commands, 0, packet).ok());
    std::uint8_t sequence = 0;
    ASSERT_TRUE(decode(bytes_of(packet), commands, sequence).ok());
    EXPECT_NEAR(commands.robots[0].wheels.left_mps, read, 1e-5) << sent;
    EXPECT_NEAR(commands.robots[0].wheels.right_mps, -read, 1e-5) << sent;
  }
}

TEST(Packet, StopPacketsContainNoSpeed) {
  Commands commands = sample_commands();
  commands.stop = true;
  Packet packet;
  ASSERT_TRUE(encode(commands, 7, packet).ok());
  for (std::size_t i = 0; i < commands.robots.size(); ++i) {
    for (std::size_t k = 1; k < kPacketRobotBytes; ++k) {
      EXPECT_EQ(packet[packet_header_bytes(kNoTeamNumber) + i * kPacketRobotBytes + k], std::byte{0});
    }
  }
  Commands read;
  read.stop = false;
  std::uint8_t sequence = 0;
  ASSERT_TRUE(decode(bytes_of(packet), read, sequence).ok());
  EXPECT_TRUE(read.stop);
  EXPECT_EQ(read.robots.size(), 2u);
}

TEST(Packet, IsNotWrittenFromAmbiguousCommands) {
  Packet packet;
  Commands unknown = sample_commands();
  unknown.robots.push_back(robot(kUnknownId, 0, 0));
  EXPECT_EQ(encode(unknown, 0, packet).code(), ErrorCode::kOutOfRange);
  EXPECT_TRUE(packet.empty());
  Commands twice = sample_commands();
  twice.robots.push_back(robot(3, 0, 0));
  EXPECT_EQ(encode(twice, 0, packet).code(), ErrorCode::kInconsistent);
  EXPECT_TRUE(packet.empty());
  Commands overflowed;
  for (int i = 0; i < 12; ++i) overflowed.robots.push_back(robot(static_cast<RobotId>(i), 0, 0));
  EXPECT_EQ(encode(overflowed, 0, packet).code(), ErrorCode::kFull);
  EXPECT_TRUE(packet.empty());
}

TEST(Packet, WithAnyOneToThreeBitsFlippedIsRejected) {
  Packet packet;
  ASSERT_TRUE(encode(sample_commands(), 42, packet).ok());
  const std::size_t bits = packet.size() * 8;
  const auto turn = [](Packet& p, std::size_t bit) { p[bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8); };
  Commands read = sample_commands();
  std::uint8_t sequence = 99;
  for (std::size_t i = 0; i < bits; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      for (std::size_t n = 0; n <= k; ++n) {
        Packet damaged = packet;  // flips one bit if i == k == n, only bit i if i > k == n, three bits if i > k > n
        turn(damaged, i);
        turn(damaged, k);
        turn(damaged, n);
        ASSERT_EQ(decode(bytes_of(damaged), read, sequence).code(), ErrorCode::kCorruptFrame);
        if (i != k) {
          damaged = packet;
          turn(damaged, i);
          turn(damaged, k);
          ASSERT_EQ(decode(bytes_of(damaged), read, sequence).code(), ErrorCode::kCorruptFrame);
        }
      }
    }
  }
  EXPECT_EQ(sequence, 99) << "a rejected packet must change nothing";
  EXPECT_EQ(read.robots.size(), 2u);
}

TEST(Packet, TruncatedAnywhereIsRejected) {
  Packet packet;
  ASSERT_TRUE(encode(sample_commands(), 42, packet).ok());
  Commands read;
  std::uint8_t sequence = 0;
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_FALSE(decode(bytes_of(packet).first(size), read, sequence).ok());
    EXPECT_FALSE(decode(bytes_of(packet).last(size), read, sequence).ok());
  }
  packet.push_back(std::byte{0});
  EXPECT_FALSE(decode(bytes_of(packet), read, sequence).ok());
}

// Writes the checksum of the bytes before it, so that only the field under test is invalid.
void seal(Packet& packet) {
  const std::uint16_t crc = checksum(CheckKind::kCrc16Ccitt, bytes_of(packet).first(packet.size() - 2));
  packet[packet.size() - 2] = static_cast<std::byte>(crc & 0xFFu);
  packet[packet.size() - 1] = static_cast<std::byte>(crc >> 8u);
}

TEST(Packet, WithWrongFieldsButAValidChecksumIsRejected) {
  Packet good;
  ASSERT_TRUE(encode(sample_commands(), 42, good).ok());
  struct Fault {
    std::size_t at;
    std::byte value;
  };
  const std::vector<Fault> faults = {{0, std::byte{0x55}}, {1, std::byte{0x4D}}, {2, std::byte{2}},
                                     {5, std::byte{1}},    {5, std::byte{3}},    {5, std::byte{12}},
                                     {5, std::byte{255}},  {6, std::byte{0x80}}, {6, std::byte{3}}};
  Commands read;
  std::uint8_t sequence = 0;
  for (const Fault& fault : faults) {
    Packet packet = good;
    packet[fault.at] = fault.value;
    seal(packet);
    EXPECT_EQ(decode(bytes_of(packet), read, sequence).code(), ErrorCode::kCorruptFrame) << "byte " << fault.at;
  }
  Packet reserved = good;
  reserved[3] = std::byte{0xFE};
  seal(reserved);
  ASSERT_TRUE(decode(bytes_of(reserved), read, sequence).ok()) << "reserved flags are ignored";
  EXPECT_FALSE(read.stop);
}

TEST(Packet, WithATeamNumberIsOfVersionTwoAndForThatTeamOnly) {
  Packet packet;
  ASSERT_TRUE(encode(sample_commands(), 42, packet, 7).ok());
  EXPECT_EQ(packet.size(), packet_bytes(2, 7));
  EXPECT_EQ(packet[2], kPacketVersion2);
  EXPECT_EQ(packet[5], std::byte{7});
  Commands read;
  std::uint8_t sequence = 0;
  for (int team = 0; team < 256; ++team) {
    EXPECT_EQ(decode(bytes_of(packet), read, sequence, static_cast<TeamNumber>(team)).ok(), team == 7) << team;
  }
  ASSERT_TRUE(decode(bytes_of(packet), read, sequence, 7).ok());
  EXPECT_EQ(sequence, 42);
  ASSERT_EQ(read.robots.size(), 2u);
  EXPECT_NEAR(read.robots[1].wheels.left_mps, 1.234f, 1e-5);
  // A robot with a team number does not obey packets without one.
  ASSERT_TRUE(encode(sample_commands(), 42, packet).ok());
  EXPECT_EQ(packet[2], kPacketVersion1);
  EXPECT_FALSE(decode(bytes_of(packet), read, sequence, 7).ok());
  // No sender has number 0.
  ASSERT_TRUE(encode(sample_commands(), 42, packet, 7).ok());
  packet[5] = std::byte{0};
  seal(packet);
  for (const TeamNumber team : {TeamNumber{0}, TeamNumber{7}})
    EXPECT_FALSE(decode(bytes_of(packet), read, sequence, team).ok());
}

TEST(Packet, WithATeamNumberAndAnyOneOrTwoBitsFlippedIsRejectedByEveryTeam) {
  Packet packet;
  ASSERT_TRUE(encode(sample_commands(), 42, packet, 7).ok());
  const auto flip = [](Packet& p, std::size_t bit) { p[bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8); };
  Commands read;
  std::uint8_t sequence = 0;
  for (std::size_t i = 0; i < packet.size() * 8; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      Packet damaged = packet;
      flip(damaged, i);
      if (k != i) flip(damaged, k);
      const TeamNumber team = std::to_integer<TeamNumber>(damaged[5]);
      ASSERT_FALSE(decode(bytes_of(damaged), read, sequence, team).ok()) << i << " " << k;
    }
  }
}

TEST(Packet, RandomBytesAreRejected) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> byte(0, 255), size(0, 140);
  int accepted = 0;
  for (int i = 0; i < 200000; ++i) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(size(random)));
    for (std::byte& b : bytes) b = static_cast<std::byte>(byte(random));
    if (bytes.size() >= 6) {  // otherwise hardly any would pass the first checks
      bytes[0] = kPacketMagic0;
      bytes[1] = kPacketMagic1;
      bytes[2] = kPacketVersion1;
      bytes[5] = static_cast<std::byte>((bytes.size() - 6) / 5);
    }
    Commands read;
    std::uint8_t sequence = 0;
    if (decode(bytes, read, sequence).ok()) {
      ++accepted;
      EXPECT_LE(read.robots.size(), kMaxRobotsPerTeam);
    }
  }
  // One twelfth of the sizes matches a count. Of these, one in 65536 passes by chance.
  EXPECT_LE(accepted, 5);
}

}  // namespace
}  // namespace touchline
