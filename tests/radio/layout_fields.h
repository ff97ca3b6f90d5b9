#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "core/radio/packet.h"
#include "core/radio/packet_layout.h"

// Layouts and packets of tests.
namespace touchline {

inline PacketField field_of(FieldValue value, FieldType type, double scale = 1.0, int block = 0) {
  PacketField field;
  field.value = value;
  field.type = type;
  field.scale = scale;
  field.block = static_cast<std::uint8_t>(block);
  return field;
}

inline PacketField text_of(PacketLayout& layout, std::string_view text, int block = 0, bool between = false) {
  PacketField field = field_of(FieldValue::kConstant, FieldType::kBytes, 1.0, block);
  field.between = between;
  field.text_at = static_cast<std::uint16_t>(layout.text.size());
  field.text_size = static_cast<std::uint8_t>(text.size());
  for (const char c : text) layout.text.push_back(static_cast<std::byte>(c));
  return field;
}

inline void add_check(PacketLayout& layout, CheckKind kind, bool big_endian = false) {
  PacketField check = field_of(FieldValue::kCheck, check_bytes(kind) == 1 ? FieldType::kU8 : FieldType::kU16);
  check.check = kind;
  check.big_endian = big_endian;
  check.end = static_cast<std::uint8_t>(layout.fields.size());
  layout.fields.push_back(check);
}

inline Commands drive(std::initializer_list<RobotCommand> robots) {
  Commands commands;
  commands.stop = false;
  for (const RobotCommand& robot : robots) commands.robots.push_back(robot);
  return commands;
}

inline Packet packet_of(const PacketLayout& layout, const Commands& commands, std::uint8_t sequence = 1) {
  OutgoingPackets packets;
  EXPECT_TRUE(encode(layout, commands, {commands.stop, false, sequence, {}}, packets).ok());
  return packets.empty() ? Packet{} : packets[0].packet;
}

inline std::string text_in(const Packet& packet) {
  std::string text;
  for (const std::byte byte : packet) text += std::to_integer<char>(byte);
  return text;
}

/// Wheel speeds in bits, as the packets of some robots on nRF24 modules.
inline PacketLayout bit_layout() {
  PacketLayout layout;
  layout.fields.push_back(field_of(FieldValue::kUnused, FieldType::kBits));
  layout.fields[0].bits = 4;
  layout.fields.push_back(field_of(FieldValue::kId, FieldType::kBits));
  layout.fields[1].bits = 4;
  for (const FieldValue value : {FieldValue::kLeft, FieldValue::kRight}) {
    PacketField speed = field_of(value, FieldType::kSignedBits, 1000.0);
    speed.bits = 18;
    layout.fields.push_back(speed);
  }
  layout.one_each = true;
  for (const int id : {2, 5}) layout.receivers.push_back({static_cast<RobotId>(id), 0});
  return layout;
}

}  // namespace touchline
