// Places, widths, counters and limits of numbers in packets.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "core/radio/packet_stream.h"
#include "tests/radio/layout_fields.h"

namespace touchline {
namespace {

std::vector<int> numbers_in(const Packet& packet) {
  std::vector<int> out;
  for (const std::byte byte : packet) out.push_back(std::to_integer<int>(byte));
  return out;
}

PacketField bits_of(FieldValue value, std::uint8_t bits, int block = 0) {
  PacketField field = field_of(value, FieldType::kBits, 1.0, block);
  field.bits = bits;
  return field;
}

// Encoded and decoded with speeds of whole centimeters per second.
Commands read_back(const PacketLayout& layout, const Commands& commands) {
  const Packet packet = packet_of(layout, commands);
  ParsedPacket read;
  EXPECT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, kUnknownId, read).ok());
  return read.commands;
}

TEST(PacketNumbers, PlacesWithoutARobotStopNoRobotOfTheTeam) {
  PacketLayout layout;
  layout.slots = 4;
  layout.fields.push_back(field_of(FieldValue::kId, FieldType::kU8, 1.0, 1));
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kI8, 100.0, 1));
  layout.fields.push_back(field_of(FieldValue::kRight, FieldType::kI8, 100.0, 1));
  for (const RobotId id : {RobotId{0}, RobotId{2}}) layout.receivers.push_back({id, 0});
  const Packet packet = packet_of(layout, drive({{0, {}, {0.5f, 0.5f}}}));
  EXPECT_EQ(numbers_in(packet), (std::vector<int>{0, 50, 50, 2, 0, 0, 1, 0, 0, 3, 0, 0}));
  EXPECT_EQ(read_back(layout, drive({{0, {}, {0.5f, 0.5f}}})).robots.size(), 4U);
}

TEST(PacketNumbers, ABlockBeginsWithAByte) {
  PacketLayout layout;
  layout.slots = 2;
  layout.fields.push_back(bits_of(FieldValue::kSequence, 4));
  layout.fields.push_back(bits_of(FieldValue::kId, 4, 1));
  for (const FieldValue value : {FieldValue::kLeft, FieldValue::kRight}) {
    PacketField field = bits_of(value, 6, 1);
    field.type = FieldType::kSignedBits;
    field.scale = 10.0;
    layout.fields.push_back(field);
  }
  add_check(layout, CheckKind::kXor8);
  for (const RobotId id : {RobotId{9}, RobotId{10}}) layout.receivers.push_back({id, 0});
  const Commands commands = read_back(layout, drive({{9, {}, {0.5f, -0.5f}}, {10, {}, {1.0f, 2.0f}}}));
  ASSERT_EQ(commands.robots.size(), 2U);
  EXPECT_EQ(commands.robots[1].id, 10);
  EXPECT_NEAR(commands.robots[0].wheels.right_mps, -0.5f, 1e-6);
  EXPECT_NEAR(commands.robots[1].wheels.right_mps, 2.0f, 1e-6);
  EXPECT_EQ(largest_packet(layout, 2), packet_of(layout, drive({})).size());
}

TEST(PacketNumbers, AListOfTheWholeTeamNeedsNoCount) {
  PacketLayout layout;
  layout.fields.push_back(text_of(layout, "["));
  layout.fields.push_back(field_of(FieldValue::kId, FieldType::kU8, 1.0, 1));
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kI8, 100.0, 1));
  layout.fields.push_back(field_of(FieldValue::kRight, FieldType::kI8, 100.0, 1));
  layout.fields.push_back(text_of(layout, "]"));
  for (const RobotId id : {RobotId{3}, RobotId{5}}) layout.receivers.push_back({id, 0});
  const Commands commands = read_back(layout, drive({{5, {}, {0.5f, 0.25f}}}));
  ASSERT_EQ(commands.robots.size(), 2U);
  EXPECT_NEAR(commands.robots[1].wheels.right_mps, 0.25f, 1e-6);
}

// A packet that is larger than its bound would not be sent at all.
TEST(PacketNumbers, LargestPacketCountsUnusedBitsAndRoundedDigits) {
  PacketLayout layout;
  layout.fields.push_back(bits_of(FieldValue::kId, 4, 1));
  layout.fields.push_back(field_of(FieldValue::kLeft, FieldType::kI8, 100.0, 1));
  layout.fields.push_back(bits_of(FieldValue::kUnused, 4, 1));
  PacketField digits = field_of(FieldValue::kRight, FieldType::kDigits, 1.0, 1);
  digits.decimals = 2;
  digits.low = -9.996;  // is sent as -10.00
  digits.high = 9.996;
  layout.fields.push_back(digits);
  layout.fields.push_back(text_of(layout, ",", 1, true));
  for (RobotId id = 0; id < 11; ++id) layout.receivers.push_back({id, 0});
  Commands commands = drive({});
  for (RobotId id = 0; id < 11; ++id) commands.robots.push_back({id, {}, {1.0f, -99.0f}});
  EXPECT_EQ(packet_of(layout, commands).size(), 11U * 9U + 10U);
  EXPECT_EQ(largest_packet(layout, 11), 11U * 9U + 10U);
}

TEST(PacketNumbers, DigitsNeverExceedTheirWidth) {
  PacketLayout layout;
  PacketField number = field_of(FieldValue::kLeft, FieldType::kDigits, 1000.0);
  number.width = 4;
  layout.fields.push_back(number);
  number.value = FieldValue::kRight;
  number.decimals = 1;
  layout.fields.push_back(number);
  layout.one_each = true;
  layout.receivers.push_back({1, 0});
  EXPECT_EQ(text_in(packet_of(layout, drive({{1, {}, {-30.0f, -30.0f}}}))), "-999-9.9");
  EXPECT_EQ(text_in(packet_of(layout, drive({{1, {}, {30.0f, 30.0f}}}))), "999999.9");
  EXPECT_EQ(text_in(packet_of(layout, drive({{1, {}, {-0.0f, -0.00004f}}}))), "000000.0");
}

TEST(PacketNumbers, CountersUseAllBitsOfTheirField) {
  PacketLayout layout = bit_layout();
  layout.fields.push_back(field_of(FieldValue::kSequence, FieldType::kU16));
  PacketField digits = field_of(FieldValue::kSequence, FieldType::kDigits);
  digits.width = 2;
  digits.high = 99;
  layout.fields.push_back(digits);
  OutgoingPackets packets;
  ASSERT_TRUE(encode(layout, drive({}), {false, false, 0x1234, {}}, packets).ok());
  const std::vector<int> bytes = numbers_in(packets[0].packet);
  ASSERT_EQ(bytes.size(), 10U);
  EXPECT_EQ(std::vector<int>(bytes.begin() + 6, bytes.end()), (std::vector<int>{0x34, 0x12, '6', '0'}));
}

// 15, 0, 1: the robot obeys each of them.
TEST(PacketNumbers, ShortCountersWrapAround) {
  PacketLayout layout = bit_layout();
  layout.fields.push_back(bits_of(FieldValue::kSequence, 4));
  SequenceFilter filter;
  for (std::uint8_t sequence = 14; sequence < 18; ++sequence) {
    const Packet packet = packet_of(layout, drive({}), sequence);
    ParsedPacket read;
    ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, kUnknownId, read).ok());
    EXPECT_TRUE(filter.obey(read.sequence, false)) << static_cast<int>(sequence);
    EXPECT_FALSE(filter.obey(read.sequence, false)) << static_cast<int>(sequence);
  }
}

TEST(PacketNumbers, CodesAreSentAsTheyAre) {
  PacketLayout layout = bit_layout();
  PacketField stop = field_of(FieldValue::kStop, FieldType::kU8, 10.0);
  stop.codes = {1, 2, 0, 0};
  stop.offset = 100.0;
  layout.fields.push_back(stop);
  EXPECT_EQ(packet_of(layout, drive({})).back(), std::byte{1});
  const Packet packet = packet_of(layout, Commands{});
  ParsedPacket read;
  ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, kUnknownId, read).ok());
  EXPECT_TRUE(read.stop);
}

// A float cannot represent 0.1.
TEST(PacketNumbers, ConstantsThatAreRoundedAreReadBack) {
  PacketLayout layout = bit_layout();
  PacketField constant = field_of(FieldValue::kConstant, FieldType::kF32);
  constant.offset = 0.1;
  layout.fields.push_back(constant);
  static_cast<void>(read_back(layout, drive({})));
}

TEST(PacketNumbers, ALengthBelowZeroIsSentAsZero) {
  PacketLayout layout = bit_layout();
  PacketField length = field_of(FieldValue::kLength, FieldType::kU8);
  length.offset = -100.0;
  length.end = 2;
  layout.fields.push_back(length);
  EXPECT_EQ(packet_of(layout, drive({})).back(), std::byte{0});
}

// What is left of a robot's motion when it stands would make its motors hum or creep.
TEST(PacketNumbers, APwmCurveSendsNothingBelowHalfAMillimeterPerSecond) {
  PacketLayout layout;
  layout.pwm.push_back({0.0f, 0.2f});
  layout.pwm.push_back({1.0f, 1.0f});
  EXPECT_EQ(pwm_share(layout, 0.0004), 0.0);
  EXPECT_EQ(pwm_share(layout, -0.0004), 0.0);
  EXPECT_LT(pwm_share(layout, -0.0006), -0.2);
  EXPECT_TRUE(std::isnan(pwm_share(layout, std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace touchline
