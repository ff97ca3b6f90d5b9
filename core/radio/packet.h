#pragma once

#include <cstdint>
#include <span>

#include "core/types.h"

// The command packet of docs/radio.md, byte by byte:
//   'T' 'L' | version | flags | sequence | [team] | count | count x (id, left int16, right int16) | CRC int16
// Version 1 has no team, so its robots obey every sender on their channel. Version 2 has one.
// Numbers of two bytes are little endian, wheel speeds are in millimeters per second.
namespace touchline {

constexpr std::byte kPacketMagic0{0x54}, kPacketMagic1{0x4C};  // "TL"
constexpr std::byte kPacketVersion1{1}, kPacketVersion2{2};
constexpr std::byte kPacketFlagStop{0x01};
constexpr std::size_t kPacketRobotBytes = 5, kPacketCrcBytes = 2;

/// The sender's team, 1 to 255. kNoTeamNumber: the packet has none and is of version 1.
using TeamNumber = std::uint8_t;
constexpr TeamNumber kNoTeamNumber = 0;

constexpr std::size_t packet_header_bytes(TeamNumber team) { return team == kNoTeamNumber ? 6 : 7; }
constexpr std::size_t packet_bytes(std::size_t robots, TeamNumber team = kNoTeamNumber) {
  return packet_header_bytes(team) + robots * kPacketRobotBytes + kPacketCrcBytes;
}
constexpr std::size_t kMaxCommandPacketBytes = packet_bytes(kMaxRobotsPerTeam, 255);
static_assert(kMaxCommandPacketBytes <= kMaxPacketBytes);

/// Resolution of the wheel speeds. Speeds outside the range of int16 are saturated.
constexpr float kWheelResolutionMps = 0.001f;

/// Writes all commands into one packet. It contains wheel speeds, no twists. A stop packet (commands.stop) lists the
/// same robots with speed zero. A NaN speed is sent as zero. kFull: the list of commands has overflowed. kOutOfRange: a
/// robot has no id (below 0). kInconsistent: a duplicate id. After an error `out` is empty and nothing must be sent.
/// `team` decides on the version.
Status encode(const Commands& commands, std::uint8_t sequence, Packet& out, TeamNumber team = kNoTeamNumber);

/// Decodes the bytes of one packet, as a robot or the mock arena does. Use PacketStream for bytes from a serial line.
/// The twists are zero because they are not sent. kCorruptFrame: wrong start, version, length, checksum or id, or a
/// packet of another team than `team`; the outputs are unchanged then.
Status decode(std::span<const std::byte> bytes, Commands& commands, std::uint8_t& sequence,
              TeamNumber team = kNoTeamNumber);

/// Length of the packet that starts with `bytes` (at least one): kNoPacket or kMoreBytes (packet_sync.h) if it does not
/// start one, or is not known yet.
std::size_t packet_length(std::span<const std::byte> bytes);
/// Team of a packet whose length is known.
TeamNumber packet_team(std::span<const std::byte> bytes);

}  // namespace touchline
