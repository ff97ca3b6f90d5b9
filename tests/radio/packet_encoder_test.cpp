// Addresses of radio modules in packets.
#include "core/radio/packet_encoder.h"

#include <gtest/gtest.h>

#include <string>

#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "tests/radio/layout_fields.h"

namespace touchline {
namespace {

// The example of a transmit request in Digi's manual of XBee modules: text for the module 0013A200400A0127.
TEST(PacketAddress, HasAllBitsOfAnXbeeModule) {
  constexpr std::uint64_t kModule = 0x0013A200400A0127, kOtherMaker = 0x0014A200400A0127;
  PacketLayout layout;
  layout.one_each = true;
  layout.fields.push_back(text_of(layout, "\x7E"));
  PacketField length = field_of(FieldValue::kLength, FieldType::kU16);
  length.big_endian = true;
  length.first = 2;
  length.end = 5;
  layout.fields.push_back(length);
  layout.fields.push_back(text_of(layout, "\x10\x01"));
  PacketField address = field_of(FieldValue::kAddress, FieldType::kU64);
  address.big_endian = true;
  layout.fields.push_back(address);
  layout.fields.push_back(text_of(layout, std::string_view("\xFF\xFE\0\0TxData0A", 12)));
  add_check(layout, CheckKind::kSum8Complement);
  layout.fields.back().first = 2;
  layout.receivers.push_back({3, kModule});
  layout.receivers.push_back({4, kOtherMaker});
  OutgoingPackets packets;
  ASSERT_TRUE(encode(layout, drive({{3, {}, {}}}), {}, packets).ok());
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(text_in(packets[0].packet),
            std::string("\x7E\0\x16\x10\x01\0\x13\xA2\0\x40\x0A\x01\x27\xFF\xFE\0\0TxData0A\x13", 26));
  for (std::size_t i = 0; i < packets.size(); ++i) {
    ParsedPacket read;
    const Packet& packet = packets[i].packet;
    ASSERT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, kUnknownId, read).ok());
    ASSERT_EQ(read.commands.robots.size(), 1U);
    EXPECT_EQ(read.commands.robots[0].id, layout.receivers[i].id) << "modules differ in their highest bits";
  }
}

TEST(PacketAddress, HasAllBytesOfAMacAddressInTheOrderOfTheLayout) {
  for (const bool big_endian : {false, true}) {
    PacketLayout layout;
    layout.one_each = true;
    layout.fields.push_back(field_of(FieldValue::kAddress, FieldType::kU48));
    layout.fields.back().big_endian = big_endian;
    layout.receivers.push_back({0, 0x246F28AA0B01});
    OutgoingPackets packets;
    ASSERT_TRUE(encode(layout, drive({}), {}, packets).ok());
    EXPECT_EQ(text_in(packets[0].packet), big_endian ? "\x24\x6F\x28\xAA\x0B\x01" : "\x01\x0B\xAA\x28\x6F\x24");
    EXPECT_EQ(largest_packet(layout, 1), 6U);
  }
}

}  // namespace
}  // namespace touchline
