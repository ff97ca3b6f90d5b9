#pragma once

#include <cstdint>
#include <span>

#include "core/types.h"

// The one packet of docs/radio.md, byte by byte:
//   'T' 'L' | version | flags | sequence | count | count x (id, left int16, right int16) | CRC int16
// Numbers of two bytes are little endian, wheel speeds count millimeters a second.
namespace touchline {

constexpr std::byte kPacketMagic0{0x54}, kPacketMagic1{0x4C};  // "TL"
constexpr std::byte kPacketVersion{1};
constexpr std::byte kPacketFlagStop{0x01};
constexpr std::size_t kPacketHeaderBytes = 6, kPacketRobotBytes = 5, kPacketCrcBytes = 2;
constexpr std::size_t packet_bytes(std::size_t robots) {
  return kPacketHeaderBytes + robots * kPacketRobotBytes + kPacketCrcBytes;
}
static_assert(packet_bytes(kMaxRobotsPerTeam) <= kMaxPacketBytes);

/// Speeds are sent in steps of this; what an int16 cannot hold is saturated at its ends.
constexpr float kWheelResolutionMps = 0.001f;

/// Writes all commands into one packet. The twists are not sent: a robot gets its wheels' speeds.
/// A stop packet (commands.stop) carries the same robots with speed zero. Speeds that are no numbers become zero.
/// kFull: the list of commands had overflowed. kOutOfRange: a robot has no id (below 0). kInconsistent: an id stands
/// there twice. After an error `out` is empty, and nothing must be sent.
Status encode(const Commands& commands, std::uint8_t sequence, Packet& out);

/// What a robot (or the mock arena) does with the bytes of one packet; see PacketStream for bytes from a line.
/// The commands' twists are zero: they are not sent. kCorruptFrame: wrong start, version, length, checksum or id;
/// nothing is changed then.
Status decode(std::span<const std::byte> bytes, Commands& commands, std::uint8_t& sequence);

}  // namespace touchline
