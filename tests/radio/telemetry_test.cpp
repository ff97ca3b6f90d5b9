#include "core/radio/telemetry.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/radio/layout_fields.h"
#include "tests/radio/noisy_line.h"
#include "tests/radio/touchline_packets.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;
constexpr Instant kNow{100s};

RobotTelemetry telemetry_of(int id, int sequence, float battery_v = 7.4f, int link = 98) {
  return {static_cast<RobotId>(id), static_cast<std::uint8_t>(sequence), battery_v, static_cast<std::int8_t>(link)};
}

void append(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

std::vector<std::uint8_t> sequences_in(const std::vector<std::byte>& bytes, std::uint64_t* skipped = nullptr) {
  TelemetryStream stream;
  RobotTelemetry telemetry;
  std::vector<std::uint8_t> found;
  for (const std::byte byte : bytes) {
    stream.push(byte);
    while (stream.next(telemetry)) found.push_back(telemetry.sequence);
  }
  if (skipped != nullptr) *skipped = stream.skipped_bytes();
  return found;
}

TEST(Telemetry, IsReadBackAsWritten) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> id(0, 127), byte(0, 255), link(-1, 100), battery(0, 65535);
  for (int i = 0; i < 2000; ++i) {
    const float battery_v = static_cast<float>(battery(random)) * 0.001f;
    const RobotTelemetry sent = telemetry_of(id(random), byte(random), battery_v, link(random));
    RobotTelemetry read;
    ASSERT_TRUE(decode_telemetry(encode_telemetry(sent), read).ok());
    EXPECT_EQ(read.id, sent.id);
    EXPECT_EQ(read.sequence, sent.sequence);
    EXPECT_NEAR(read.battery_v, sent.battery_v, 1e-4);
    EXPECT_EQ(read.link_percent, sent.link_percent);
  }
}

TEST(Telemetry, RoundsAndSaturatesVoltages) {
  const std::vector<std::pair<float, float>> sent_and_read = {
      {-1.0f, 0.0f}, {0.0004f, 0.0f}, {7.4006f, 7.401f}, {70.0f, 65.535f}, {1e30f, 65.535f}, {std::nanf(""), 0.0f}};
  for (const auto& [sent, read] : sent_and_read) {
    RobotTelemetry telemetry;
    ASSERT_TRUE(decode_telemetry(encode_telemetry(telemetry_of(1, 1, sent)), telemetry).ok());
    EXPECT_NEAR(telemetry.battery_v, read, 1e-4) << sent;
  }
}

TEST(Telemetry, WithAnyOneToThreeBitsFlippedIsRejected) {
  const Packet good = encode_telemetry(telemetry_of(3, 42));
  constexpr std::size_t kBits = kTelemetryBytes * 8;
  const auto turn = [](Packet& p, std::size_t bit) { p[bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8); };
  RobotTelemetry read = telemetry_of(9, 9);
  for (std::size_t i = 0; i < kBits; ++i) {
    for (std::size_t k = i; k < kBits; ++k) {
      for (std::size_t n = k; n < kBits; ++n) {
        Packet damaged = good;  // flips only bit i if n == k > i
        turn(damaged, i);
        if (k > i) turn(damaged, k);
        if (n > i) turn(damaged, n);
        ASSERT_EQ(decode_telemetry(damaged, read).code(), ErrorCode::kCorruptFrame) << i << " " << k << " " << n;
      }
    }
  }
  EXPECT_EQ(read.id, 9) << "a rejected packet changes nothing";
}

TEST(Telemetry, WithAWrongFieldButAValidChecksumIsRejected) {
  RobotTelemetry read;
  EXPECT_TRUE(decode_telemetry(encode_telemetry(telemetry_of(127, 1, 7.4f, 100)), read).ok());
  EXPECT_FALSE(decode_telemetry(encode_telemetry(telemetry_of(1, 1, 7.4f, 101)), read).ok()) << "101 percent";
  const Packet good = encode_telemetry(telemetry_of(1, 1));
  Packet wrong_id = good;
  wrong_id[3] = std::byte{128};
  const std::uint16_t crc = checksum(CheckKind::kCrc16Ccitt, bytes_of(wrong_id).first(8));
  wrong_id[8] = static_cast<std::byte>(crc & 0xFFu);
  wrong_id[9] = static_cast<std::byte>(crc >> 8u);
  EXPECT_FALSE(decode_telemetry(wrong_id, read).ok()) << "id 128";
  EXPECT_FALSE(decode_telemetry(std::span(good).first(9), read).ok());
}

TEST(TelemetryStream, LosesOnlyTheTruncatedPacket) {
  const Packet before = encode_telemetry(telemetry_of(1, 1)), cut = encode_telemetry(telemetry_of(2, 2)),
               after = encode_telemetry(telemetry_of(3, 3));
  for (std::size_t begin = 0; begin < kTelemetryBytes; ++begin) {
    for (std::size_t gone = 1; begin + gone <= kTelemetryBytes; ++gone) {
      std::vector<std::byte> bytes;
      append(bytes, before);
      append(bytes, std::span(cut).first(begin));
      append(bytes, std::span(cut).subspan(begin + gone));
      append(bytes, after);
      std::uint64_t skipped = 0;
      EXPECT_EQ(sequences_in(bytes, &skipped), (std::vector<std::uint8_t>{1, 3})) << begin << " " << gone;
      EXPECT_EQ(skipped, kTelemetryBytes - gone);
    }
  }
}

// A radio module that returns our own packets, or receives them from another module.
TEST(TelemetryStream, IgnoresOurOwnPackets) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({0, {}, {21.076f, 0.001f}});  // 0x5254: "TR" within it, followed by the version
  Packet packet;
  ASSERT_TRUE(encode(commands, 1, packet).ok());
  std::vector<std::byte> bytes;
  for (int i = 0; i < 50; ++i) {
    append(bytes, {packet.data(), packet.size()});
    append(bytes, encode_telemetry(telemetry_of(1, i)));
  }
  EXPECT_EQ(sequences_in(bytes).size(), 50U);
}

// Bytes are lost, inserted and corrupted, and random bytes start like a packet. Only sent packets are reported, and all
// intact packets after intact ones are found.
TEST(TelemetryStream, ReportsOnlySentPacketsOnANoisyLine) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> byte(0, 255), kind(0, 3), size(0, 40);
  testing::NoisyLine line(random);
  std::vector<std::byte>& bytes = line.received();
  int whole = 0;
  constexpr int kSent = 20000;
  for (int i = 0; i < kSent; ++i) {
    whole += line.send(encode_telemetry(telemetry_of(i % 11, i, 7.4f, 42))) ? 1 : 0;
    if (kind(random) == 0) {
      for (int k = size(random); k > 0; --k) bytes.push_back(static_cast<std::byte>(byte(random)));
    }
    if (kind(random) == 1) append(bytes, std::array{kTelemetryMagic0, kTelemetryMagic1, kTelemetryVersion});
  }
  TelemetryStream stream;
  RobotTelemetry telemetry;
  int found = 0, wrong = 0;
  for (const std::byte b : bytes) {
    stream.push(b);
    while (stream.next(telemetry)) {
      ++found;
      wrong += telemetry.link_percent == 42 && std::abs(telemetry.battery_v - 7.4f) < 1e-4f ? 0 : 1;
    }
  }
  EXPECT_EQ(wrong, 0);
  // A byte inserted after the last one leaves the packet intact.
  EXPECT_GE(found, whole);
  EXPECT_LE(found, whole + kSent / 50);
  EXPECT_GT(whole, kSent / 2);
}

TEST(TelemetryStream, AcceptsGarbageAsRarelyAsTheChecksumAllows) {
  std::mt19937 random(6);
  std::uniform_int_distribution<int> byte(0, 255), kind(0, 4);
  TelemetryStream stream;
  RobotTelemetry telemetry;
  int accepted = 0;
  std::uint64_t pushed = 0;
  const auto push = [&](std::byte b) {
    stream.push(b);
    ++pushed;
    while (stream.next(telemetry)) ++accepted;
  };
  for (int i = 0; i < 100000; ++i) {
    if (kind(random) == 0) {
      for (const std::byte b : {kTelemetryMagic0, kTelemetryMagic1, kTelemetryVersion}) push(b);
    }
    push(static_cast<std::byte>(byte(random)));
  }
  EXPECT_LE(accepted, 3) << "20000 starts, one in 65536 of them by chance";
  EXPECT_GE(stream.skipped_bytes() + 20, pushed);
}

class RobotMonitorTest : public ::testing::Test {
 protected:
  void hear(const RobotTelemetry& telemetry, Instant now = kNow) {
    monitor.listen(encode_telemetry(telemetry), now, reports);
  }
  void hear_battery(float battery_v, int times) {
    for (int i = 0; i < times; ++i) hear(telemetry_of(4, ++sequence, battery_v));
  }
  RobotMonitor monitor;
  RobotReports reports;
  int sequence = 0;
};

TEST_F(RobotMonitorTest, KeepsTheLastTelemetryOfEachRobotSortedById) {
  for (const int id : {7, 2, 9, 0}) hear(telemetry_of(id, 10, 7.0f + 0.1f * static_cast<float>(id)));
  hear(telemetry_of(2, 11, 6.9f, 50), kNow + 1s);
  ASSERT_EQ(reports.robots.size(), 4U);
  const std::array<RobotId, 4> ids{0, 2, 7, 9};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(reports.robots[i].last.id, ids[i]);
  const RobotReport& two = reports.robots[1];
  EXPECT_NEAR(two.last.battery_v, 6.9, 1e-4);
  EXPECT_EQ(two.last.link_percent, 50);
  EXPECT_EQ(two.heard, kNow + 1s);
  EXPECT_EQ(two.packets, 2U);
  EXPECT_EQ(two.missed, 0U);
  EXPECT_EQ(reports.robots[2].heard, kNow);
  EXPECT_EQ(reports.packets, 5U);
}

/// "R", battery in 0.1 V, and wheel speeds in cm/s: nothing tells which robot it is.
PacketLayout nameless_layout() {
  PacketLayout layout;
  layout.one_each = true;
  layout.fields.push_back(text_of(layout, "R"));
  layout.fields.push_back(field_of(FieldValue::kBattery, FieldType::kU8, 10.0));
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kI8, 100.0));
  layout.fields.push_back(field_of(FieldValue::kRight, FieldType::kI8, 100.0));
  layout.receivers.push_back({5, 0});
  layout.receivers.push_back({2, 0});
  return layout;
}

TEST_F(RobotMonitorTest, ReportsThatNameNoRobotAreTheirSenders) {
  const PacketLayout layout = nameless_layout();
  monitor.configure(layout, 0.0f);
  RobotTelemetry said;
  std::array<Packet, 2> packets;
  for (std::size_t i = 0; i < 2; ++i) {
    said.battery_v = 7.0f + static_cast<float>(i);
    said.wheels = WheelSpeeds{0.25f, -0.5f + static_cast<float>(i)};
    ASSERT_TRUE(encode_telemetry(layout, said, packets[i]).ok());
  }
  // The bytes of two ports arrive in turn.
  for (std::size_t at = 0; at < packets[0].size(); at += 2) {
    for (std::size_t sender = 0; sender < 2; ++sender) {
      monitor.listen({packets[sender].data() + at, 2}, kNow, reports, sender);
    }
  }
  ASSERT_EQ(reports.robots.size(), 2U);
  EXPECT_EQ(reports.foreign_bytes, 0U);
  EXPECT_EQ(reports.robots[0].last.id, 2);
  EXPECT_NEAR(reports.robots[0].last.battery_v, 8.0, 1e-6);
  EXPECT_EQ(reports.robots[1].last.id, 5);
  EXPECT_NEAR(reports.robots[1].last.battery_v, 7.0, 1e-6);
  ASSERT_TRUE(reports.robots[1].last.wheels.has_value());
  EXPECT_NEAR(reports.robots[1].last.wheels->left_mps, 0.25, 1e-6);
  EXPECT_NEAR(reports.robots[1].last.wheels->right_mps, -0.5, 1e-6);
  // Nobody knows whose these are.
  monitor.listen({packets[0].data(), packets[0].size()}, kNow, reports);
  EXPECT_EQ(reports.packets, 2U);
}

TEST_F(RobotMonitorTest, ReportsThatNameNoRobotAreThoseOfTheOnlyOne) {
  PacketLayout layout = nameless_layout();
  layout.receivers.pop_back();
  monitor.configure(layout, 0.0f);
  Packet packet;
  ASSERT_TRUE(encode_telemetry(layout, RobotTelemetry{}, packet).ok());
  monitor.listen({packet.data(), packet.size()}, kNow, reports);
  ASSERT_EQ(reports.robots.size(), 1U);
  EXPECT_EQ(reports.robots[0].last.id, 5);
}

TEST_F(RobotMonitorTest, ReportsAreNamedByAddresses) {
  PacketLayout layout = nameless_layout();
  layout.fields.push_back(field_of(FieldValue::kAddress, FieldType::kU48));
  layout.receivers[1].address = 0x246F28AA0B01;
  monitor.configure(layout, 0.0f);
  Packet packet;
  const RobotValues values{.id = 2, .address = 0x246F28AA0B01, .wheels = {}};
  ASSERT_TRUE(encode_packet(layout, {&values, 1}, {}, packet).ok());
  monitor.listen({packet.data(), packet.size()}, kNow, reports);
  ASSERT_EQ(reports.robots.size(), 1U);
  EXPECT_EQ(reports.robots[0].last.id, 2);
}

TEST_F(RobotMonitorTest, CountsMissingPacketsAcrossTheWrapAround) {
  for (const int i : {253, 254, 1, 1, 2}) hear(telemetry_of(4, i));
  EXPECT_EQ(reports.robots[0].missed, 2U) << "255 and 0";
  EXPECT_EQ(reports.robots[0].packets, 4U) << "the second 1 is a repetition";
  hear(telemetry_of(4, 200));
  EXPECT_EQ(reports.robots[0].missed, 2U) << "more than 127 ahead: the robot was restarted";
}

TEST_F(RobotMonitorTest, ListsTheRobotsOfATeamAndCountsOthers) {
  for (int id = 20; id < 33; ++id) hear(telemetry_of(id, 1));
  EXPECT_EQ(reports.robots.size(), kMaxRobotsPerTeam);
  EXPECT_EQ(reports.robots.overflow(), 2U);
  EXPECT_EQ(reports.robots[10].last.id, 30);
  hear(telemetry_of(30, 2));
  EXPECT_EQ(reports.robots[10].packets, 2U);
}

TEST_F(RobotMonitorTest, ABatteryIsLowAfterThreePacketsAndGoodAfterItsReplacement) {
  monitor.configure(touchline_telemetry_layout(), 7.0f);
  hear_battery(6.9f, 2);
  hear_battery(7.1f, 1);
  hear_battery(6.9f, 2);
  EXPECT_FALSE(reports.robots[0].battery_low) << "the motors started twice";
  hear_battery(6.9f, 1);
  EXPECT_TRUE(reports.robots[0].battery_low);
  hear_battery(7.25f, 10);
  EXPECT_TRUE(reports.robots[0].battery_low) << "it recovers while the robot stands";
  hear_battery(8.3f, 2);
  EXPECT_TRUE(reports.robots[0].battery_low);
  hear_battery(8.3f, 1);
  EXPECT_FALSE(reports.robots[0].battery_low);
}

TEST_F(RobotMonitorTest, ABatteryThatIsNotMeasuredOrMonitoredIsNotLow) {
  monitor.configure(touchline_telemetry_layout(), 7.0f);
  hear_battery(0.0f, 10);
  EXPECT_FALSE(reports.robots[0].battery_low);
  monitor.configure(touchline_telemetry_layout(), 0.0f);
  hear_battery(0.5f, 10);
  EXPECT_FALSE(reports.robots[0].battery_low);
}

TEST_F(RobotMonitorTest, PacketsMayArriveInPiecesAndSeveralAtOnce) {
  std::vector<std::byte> bytes;
  for (int i = 0; i < 100; ++i) append(bytes, encode_telemetry(telemetry_of(i % 3, i / 3)));
  for (std::size_t at = 0, size = 1; at < bytes.size(); at += size, size = size % 37 + 1) {
    monitor.listen(std::span(bytes).subspan(at, std::min(size, bytes.size() - at)), kNow, reports);
  }
  EXPECT_EQ(reports.packets, 100U);
  EXPECT_EQ(reports.foreign_bytes, 0U);
}

}  // namespace
}  // namespace touchline
