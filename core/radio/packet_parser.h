#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/radio/packet_layout.h"
#include "core/radio/packet_sync.h"
#include "core/types.h"

namespace touchline {

/// A field of a packet that was read.
struct FieldReading {
  std::uint16_t field = 0;           // index in PacketLayout::fields
  std::uint16_t robot = 0;           // repetition of its block
  std::uint16_t begin = 0, end = 0;  // bytes that it touches
  double number = 0.0;               // as it stands on the wire; 0 for constant bytes
  std::uint64_t address = 0;         // the same of kAddress, with all bits
};
// Largest packet: 11 robots in blocks of ten fields, and fields around them.
using FieldReadings = FixedVector<FieldReading, 160>;

/// Reads the fields of the packet at the start of `bytes`, which are without framing. Returns its length, kMoreBytes if
/// all bytes agree with the layout but some are missing, or kNoPacket: a constant, count, length or check is wrong.
std::size_t parse_packet(const PacketLayout& layout, std::span<const std::byte> bytes, FieldReadings& readings);

/// What a packet says.
struct ParsedPacket {
  bool stop = false;
  bool has_sequence = false;
  std::uint8_t sequence = 0;  // lowest byte; a shorter counter stands in its highest bits, so that it wraps alike
  TeamNumber team = kNoTeamNumber;
  Commands commands;         // the twists are those of the wheels
  RobotTelemetry telemetry;  // of one robot, if the layout is one of telemetry
};

/// Decodes the bytes of one packet without framing, as a robot or the mock arena does. `receiver`: the robot that got
/// the packet, for layouts without ids that send a packet to each. kCorruptFrame: not a packet of this layout, a
/// duplicate id, or a code that has no meaning; `out` is unchanged then.
Status decode_packet(const PacketLayout& layout, std::span<const std::byte> bytes, RobotId receiver, ParsedPacket& out);
/// The same for fields that parse_packet() has read.
Status decode_packet(const PacketLayout& layout, const FieldReadings& readings, RobotId receiver, ParsedPacket& out);

/// Value of a reading in the units of FieldValue: m/s, rad/s, V, percent; a magnitude has no sign.
double value_of(const PacketLayout& layout, const FieldReading& reading);

}  // namespace touchline
