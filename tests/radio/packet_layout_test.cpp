#include "core/radio/packet_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "core/radio/packet_stream.h"
#include "tests/radio/layout_fields.h"

namespace touchline {
namespace {

TEST(PacketLayout, PacksBitsFromTheLowestOn) {
  const PacketLayout layout = bit_layout();
  OutgoingPackets packets;
  ASSERT_TRUE(encode(layout, drive({{5, {}, {1.0f, -0.001f}}}), {}, packets).ok());
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(packets[1].receiver, 1U);
  // 4 bits of 0, id 5, 1000 in 18 bits, -1 in 18 bits: 44 bits fill 6 bytes.
  const std::vector<int> expected{0x50, 0xE8, 0x03, 0xFC, 0xFF, 0x0F};
  ASSERT_EQ(packets[1].packet.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(std::to_integer<int>(packets[1].packet[i]), expected[i]) << i;
  }
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(layout, {packets[1].packet.data(), 6}, kUnknownId, read).ok());
  ASSERT_EQ(read.commands.robots.size(), 1U);
  EXPECT_EQ(read.commands.robots[0].id, 5);
  EXPECT_NEAR(read.commands.robots[0].wheels.left_mps, 1.0f, 1e-6);
  EXPECT_NEAR(read.commands.robots[0].wheels.right_mps, -0.001f, 1e-6);
}

TEST(PacketLayout, AReceiverWithoutACommandGetsSpeedZero) {
  OutgoingPackets packets;
  ASSERT_TRUE(encode(bit_layout(), drive({{5, {}, {1.0f, 1.0f}}}), {}, packets).ok());
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(bit_layout(), {packets[0].packet.data(), 6}, kUnknownId, read).ok());
  EXPECT_EQ(read.commands.robots[0].id, 2);
  EXPECT_EQ(read.commands.robots[0].wheels.left_mps, 0.0f);
}

// A robot whose wheels turn faster than they are told must be told less, whatever its packets look like. What is read
// back is what the robot is told.
TEST(PacketLayout, DividesSpeedsByTheGainsOfTheWheels) {
  PacketLayout by_place;
  by_place.slots = 3;
  by_place.fields.push_back(field_of(FieldValue::kLeft, FieldType::kF32, 1.0, 1));
  by_place.fields.push_back(field_of(FieldValue::kRight, FieldType::kF32, 1.0, 1));
  PacketLayout listed = touchline_layout();
  listed.commanded_only = false;
  for (PacketLayout layout : {bit_layout(), by_place, touchline_layout(), listed}) {
    layout.receivers.clear();
    layout.receivers.push_back({1, 0});
    layout.receivers.push_back({2, 0, {1.25f, 0.8f}});
    OutgoingPackets packets;
    ASSERT_TRUE(encode(layout, drive({{1, {}, {0.4f, 0.4f}}, {2, {}, {0.4f, -0.4f}}}), {}, packets).ok());
    FixedVector<RobotCommand, kMaxRobotsPerTeam> told;
    for (const OutgoingPacket& outgoing : packets) {
      ParsedPacket read;
      ASSERT_TRUE(decode_packet(layout, {outgoing.packet.data(), outgoing.packet.size()}, kUnknownId, read).ok());
      for (const RobotCommand& robot : read.commands.robots) told.push_back(robot);
    }
    const auto wheels_of_robot = [&](RobotId id) {
      for (const RobotCommand& robot : told) {
        if (robot.id == id) return robot.wheels;
      }
      ADD_FAILURE() << "robot " << int{id} << " is missing";
      return WheelSpeeds{};
    };
    EXPECT_NEAR(wheels_of_robot(1).left_mps, 0.4f, 1e-6) << "without gains";
    EXPECT_NEAR(wheels_of_robot(2).left_mps, 0.32f, 1e-6);
    EXPECT_NEAR(wheels_of_robot(2).right_mps, -0.5f, 1e-6);
  }
}

// A list of ids, forward speeds and turn rates in ASCII.
PacketLayout text_layout() {
  PacketLayout layout;
  layout.wheel_base_m = 0.08;
  layout.fields.push_back(text_of(layout, "<"));
  for (const FieldValue value : {FieldValue::kId, FieldValue::kForward, FieldValue::kTurn}) {
    if (value != FieldValue::kId) layout.fields.push_back(text_of(layout, ",", 1));
    PacketField number = field_of(value, FieldType::kDigits, 1.0, 1);
    number.decimals = value == FieldValue::kId ? 0 : 2;
    number.low = -99;
    number.high = 99;
    layout.fields.push_back(number);
  }
  layout.fields.push_back(text_of(layout, ",", 1, true));
  layout.fields.push_back(text_of(layout, ">"));
  for (const int id : {0, 3}) layout.receivers.push_back({static_cast<RobotId>(id), 0});
  return layout;
}

TEST(PacketLayout, WritesAndReadsListsOfNumbers) {
  const PacketLayout layout = text_layout();
  const Packet packet = packet_of(layout, drive({{3, {}, {0.46f, 0.54f}}, {0, {}, {-0.25f, -0.25f}}}));
  EXPECT_EQ(text_in(packet), "<0,-0.25,0.00,3,0.50,1.00>");
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, kUnknownId, read).ok());
  ASSERT_EQ(read.commands.robots.size(), 2U);
  EXPECT_NEAR(read.commands.robots[1].wheels.left_mps, 0.46f, 1e-5);
  EXPECT_NEAR(read.commands.robots[1].wheels.right_mps, 0.54f, 1e-5);
}

TEST(PacketLayout, FillsDigitsWithZeros) {
  PacketLayout layout;
  PacketField number = field_of(FieldValue::kLeft, FieldType::kDigits, 100.0);
  number.width = 3;
  number.magnitude = true;
  PacketField directions = field_of(FieldValue::kDirections, FieldType::kDigits);
  directions.codes = {1, 2, 3, 4};
  directions.width = 1;
  layout.fields.push_back(directions);
  layout.fields.push_back(number);
  number.value = FieldValue::kRight;
  layout.fields.push_back(number);
  layout.one_each = true;
  layout.receivers.push_back({1, 0});
  const Packet packet = packet_of(layout, drive({{1, {}, {-0.07f, 1.2f}}}));
  EXPECT_EQ(text_in(packet), "2007120");
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, 1, read).ok());
  EXPECT_NEAR(read.commands.robots[0].wheels.left_mps, -0.07f, 1e-6);
  EXPECT_NEAR(read.commands.robots[0].wheels.right_mps, 1.2f, 1e-6);
}

TEST(PacketLayout, PlacesStandForIds) {
  PacketLayout layout;
  layout.slots = 3;
  layout.first_id = 1;
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kI8, 100.0, 1));
  layout.fields.push_back(field_of(FieldValue::kRight, FieldType::kI8, 100.0, 1));
  const Packet packet = packet_of(layout, drive({{2, {}, {0.1f, -5.0f}}}));
  ASSERT_EQ(packet.size(), 6U);
  EXPECT_EQ(std::to_integer<int>(packet[2]), 10);
  EXPECT_EQ(std::to_integer<int>(packet[3]), 256 - 127) << "saturated";
  for (const std::size_t other : {0U, 1U, 4U, 5U}) EXPECT_EQ(packet[other], std::byte{0});
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, kUnknownId, read).ok());
  ASSERT_EQ(read.commands.robots.size(), 3U);
  EXPECT_EQ(read.commands.robots[1].id, 2);
}

TEST(PacketLayout, APwmCurveBeginsWhereAWheelStartsToTurn) {
  PacketLayout layout;
  layout.pwm.push_back({0.0f, 0.2f});
  layout.pwm.push_back({1.0f, 0.6f});
  layout.pwm.push_back({1.5f, 1.0f});
  EXPECT_EQ(pwm_share(layout, 0.0), 0.0);
  EXPECT_NEAR(pwm_share(layout, 0.5), 0.4, 1e-6);
  EXPECT_NEAR(pwm_share(layout, -1.25), -0.8, 1e-6);
  EXPECT_NEAR(pwm_share(layout, 9.0), 1.0, 1e-6);
  for (const double speed : {-1.4, -0.3, 0.0, 0.05, 0.9, 1.5}) {
    EXPECT_NEAR(speed_of_share(layout, pwm_share(layout, speed)), speed, 1e-6);
  }
}

TEST(PacketLayout, ALengthCoversTheFieldsAfterIt) {
  PacketLayout layout;
  layout.fields.push_back(text_of(layout, "\xAA\x55"));
  PacketField length = field_of(FieldValue::kLength, FieldType::kU8);
  length.first = 2;
  length.end = 4;
  layout.fields.push_back(length);
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kF32));
  layout.fields.push_back(field_of(FieldValue::kRight, FieldType::kF32));
  layout.one_each = true;
  layout.receivers.push_back({1, 0});
  add_check(layout, CheckKind::kXor8);
  Packet packet = packet_of(layout, drive({{1, {}, {0.25f, -1.5f}}}));
  ASSERT_EQ(packet.size(), 12U);
  EXPECT_EQ(packet[2], std::byte{8});
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, 1, read).ok());
  EXPECT_EQ(read.commands.robots[0].wheels.right_mps, -1.5f);
  packet[2] = std::byte{7};
  EXPECT_FALSE(decode_packet(layout, {packet.data(), packet.size()}, 1, read).ok());
}

TEST(PacketLayout, DoublesHaveEightBytesInEitherOrder) {
  for (const bool big_endian : {false, true}) {
    PacketLayout layout;
    layout.one_each = true;
    layout.receivers.push_back({1, 0});
    for (const FieldValue value : {FieldValue::kLeft, FieldValue::kRight}) {
      PacketField field = field_of(value, FieldType::kF64, 50.0);
      field.big_endian = big_endian;
      layout.fields.push_back(field);
    }
    const Packet packet = packet_of(layout, drive({{1, {}, {0.25f, -1.5f}}}));
    ASSERT_EQ(packet.size(), 16U);
    EXPECT_EQ(largest_packet(layout, 1), 16U);
    // 12.5 is 0x4029000000000000.
    EXPECT_EQ(packet[big_endian ? 0 : 7], std::byte{0x40});
    EXPECT_EQ(packet[big_endian ? 1 : 6], std::byte{0x29});
    ParsedPacket read;
    ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, 1, read).ok());
    EXPECT_EQ(read.commands.robots[0].wheels.left_mps, 0.25f);
    EXPECT_EQ(read.commands.robots[0].wheels.right_mps, -1.5f);
  }
}

TEST(PacketLayout, RobotsOfTheOtherColorIgnoreAPacket) {
  PacketLayout blue;
  blue.one_each = true;
  blue.receivers.push_back({1, 0});
  blue.fields.push_back(field_of(FieldValue::kColor, FieldType::kU8));
  blue.fields.push_back(field_of(FieldValue::kLeft, FieldType::kF32));
  blue.fields.push_back(field_of(FieldValue::kRight, FieldType::kF32));
  PacketLayout yellow = blue;
  yellow.is_yellow = true;
  const Packet packet = packet_of(yellow, drive({{1, {}, {0.25f, 0.25f}}}));
  EXPECT_EQ(packet[0], std::byte{1});
  ParsedPacket read;
  EXPECT_TRUE(decode_packet(yellow, {packet.data(), packet.size()}, 1, read).ok());
  EXPECT_FALSE(decode_packet(blue, {packet.data(), packet.size()}, 1, read).ok());
}

TEST(PacketLayout, BytesForTheStartComeBeforeThePacketThatAsksForThem) {
  PacketLayout layout = bit_layout();
  layout.text.push_back(std::byte{128});
  layout.text.push_back(std::byte{131});
  layout.start_size = 2;
  OutgoingPackets packets;
  PacketValues values;
  values.start = true;
  ASSERT_TRUE(encode(layout, drive({}), values, packets).ok());
  ASSERT_EQ(packets[0].packet.size(), 8U);
  EXPECT_EQ(packets[0].packet[1], std::byte{131});
  values.start = false;
  ASSERT_TRUE(encode(layout, drive({}), values, packets).ok());
  EXPECT_EQ(packets[0].packet.size(), 6U);
}

class Framings : public ::testing::TestWithParam<Framing> {};

TEST_P(Framings, PacketsSurviveBytesOfTheFramingAndDamagedNeighbors) {
  PacketLayout layout;
  layout.framing = GetParam();
  layout.one_each = true;
  layout.receivers.push_back({1, 0});
  layout.fields.push_back(text_of(layout, "\x7E"));
  layout.fields.push_back(field_of(FieldValue::kSequence, FieldType::kU8));
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kI32, 1e6));
  layout.fields.push_back(field_of(FieldValue::kRight, FieldType::kI32, 1e6));
  add_check(layout, CheckKind::kCrc16Ccitt, true);
  std::mt19937 random(7);
  // Bytes that the framings treat in a special way, and others.
  constexpr std::array<std::uint32_t, 8> kBytes{0x00, 0x7E, 0x7D, 0x11, 0x13, 0xC0, 0xDB, 0x42};
  const auto speed = [&] {
    std::uint32_t number = 0;
    for (int i = 0; i < 3; ++i) number = number << 8U | kBytes[random() % kBytes.size()];
    return static_cast<float>(number) * 1e-6f;
  };
  PacketStream stream(layout, 1);
  int found = 0, whole = 0;
  for (int i = 0; i < 3000; ++i) {
    const Packet packet = packet_of(layout, drive({{1, {}, {speed(), speed()}}}), static_cast<std::uint8_t>(i));
    const bool damaged = i % 5 == 0;
    whole += damaged ? 0 : 1;
    const std::size_t lost = random() % packet.size();
    for (std::size_t k = 0; k < packet.size(); ++k) {
      if (!damaged || k != lost) stream.push(packet[k]);
      ParsedPacket read;
      while (stream.next(read)) {
        // Without its last byte, a packet is complete when the next one begins.
        EXPECT_LE(static_cast<std::uint8_t>(i - read.sequence), 1);
        ++found;
      }
    }
  }
  // A damaged packet may take the next one with it, if what separates them was lost.
  EXPECT_GE(found, whole - 600 / 5);
  EXPECT_LE(found, whole + 600 / 5) << "without a byte of the framing, a packet may be complete";
}

INSTANTIATE_TEST_SUITE_P(All, Framings,
                         ::testing::Values(Framing::kNone, Framing::kCobs, Framing::kSlip, Framing::kXbee),
                         [](const auto& framing) {
                           return "Framing" + std::to_string(static_cast<int>(framing.param));
                         });

TEST(Checksum, HasTheCatalogsCheckValues) {
  constexpr std::string_view kDigits = "123456789";
  const auto bytes = std::as_bytes(std::span(kDigits.data(), kDigits.size()));
  const std::vector<std::pair<CheckKind, int>> expected{
      {CheckKind::kCrc8, 0xF4},           {CheckKind::kCrc8Maxim, 0xA1},     {CheckKind::kCrc16Ccitt, 0x29B1},
      {CheckKind::kCrc16Xmodem, 0x31C3},  {CheckKind::kCrc16Kermit, 0x2189}, {CheckKind::kCrc16X25, 0x906E},
      {CheckKind::kCrc16Modbus, 0x4B37},  {CheckKind::kCrc16Arc, 0xBB3D},    {CheckKind::kSum8, 0xDD},
      {CheckKind::kSum8Complement, 0x22}, {CheckKind::kSum16, 0x1DD},        {CheckKind::kXor8, 0x31}};
  for (const auto& [kind, value] : expected) EXPECT_EQ(checksum(kind, bytes), value) << static_cast<int>(kind);
}

// Any layout, fed with any bytes, must neither read outside of them nor accept damaged checks.
TEST(PacketLayout, DamagedBytesOfACheckedPacketMoveNoRobot) {
  PacketLayout layout = text_layout();
  add_check(layout, CheckKind::kCrc16Ccitt);
  const Packet packet = packet_of(layout, drive({{3, {}, {0.46f, 0.54f}}}));
  ParsedPacket read;
  for (std::size_t bit = 0; bit < packet.size() * 8; ++bit) {
    Packet damaged = packet;
    damaged[bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    EXPECT_FALSE(decode_packet(layout, {damaged.data(), damaged.size()}, kUnknownId, read).ok()) << bit;
  }
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_FALSE(decode_packet(layout, {packet.data(), size}, kUnknownId, read).ok()) << size;
  }
}

TEST(PacketLayout, LargestPacketBoundsEveryPacket) {
  const PacketLayout layout = text_layout();
  const Packet packet = packet_of(layout, drive({{3, {}, {-9.9f, 9.9f}}, {0, {}, {-9.9f, 9.9f}}}));
  EXPECT_LE(packet.size(), largest_packet(layout, 2));
  EXPECT_EQ(largest_packet(touchline_layout(), 11), 63U);
  EXPECT_EQ(largest_packet(touchline_layout(7), 11), 64U);
}

}  // namespace
}  // namespace touchline
