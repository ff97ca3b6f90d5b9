#pragma once

#include <cstdint>
#include <span>

#include "core/types.h"

// The command packet of docs/radio.md, byte by byte:
//   'T' 'L' | version | flags | sequence | count | count x (id, left int16, right int16) | CRC int16
// Numbers of two bytes are little endian, wheel speeds are in millimeters per second.
namespace touchline {

constexpr std::byte kPacketMagic0{0x54}, kPacketMagic1{0x4C};  // "TL"
constexpr std::byte kPacketVersion{1};
constexpr std::byte kPacketFlagStop{0x01};
constexpr std::size_t kPacketHeaderBytes = 6, kPacketRobotBytes = 5, kPacketCrcBytes = 2;
constexpr std::size_t packet_bytes(std::size_t robots) {
  return kPacketHeaderBytes + robots * kPacketRobotBytes + kPacketCrcBytes;
}
static_assert(packet_bytes(kMaxRobotsPerTeam) <= kMaxPacketBytes);

/// Resolution of the wheel speeds. Speeds outside the range of int16 are saturated.
constexpr float kWheelResolutionMps = 0.001f;

/// Writes all commands into one packet. It contains wheel speeds, no twists. A stop packet (commands.stop) lists the
/// same robots with speed zero. A NaN speed is sent as zero. kFull: the list of commands has overflowed. kOutOfRange: a
/// robot has no id (below 0). kInconsistent: a duplicate id. After an error `out` is empty and nothing must be sent.
Status encode(const Commands& commands, std::uint8_t sequence, Packet& out);

/// Decodes the bytes of one packet, as a robot or the mock arena does. Use PacketStream for bytes from a serial line.
/// The twists are zero because they are not sent. kCorruptFrame: wrong start, version, length, checksum or id; the
/// outputs are unchanged then.
Status decode(std::span<const std::byte> bytes, Commands& commands, std::uint8_t& sequence);

}  // namespace touchline
