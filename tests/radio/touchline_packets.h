#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "core/radio/packet_stream.h"
#include "core/radio/telemetry.h"

// Touchline's own packets (docs/radio.md), for tests that write and read single ones.
namespace touchline {

constexpr std::byte kPacketMagic0{0x54}, kPacketMagic1{0x4C}, kPacketVersion1{1}, kPacketVersion2{2};
constexpr std::byte kPacketFlagStop{0x01};
constexpr std::byte kTelemetryMagic0{0x54}, kTelemetryMagic1{0x52}, kTelemetryVersion{1};
constexpr std::size_t kPacketRobotBytes = 5, kTelemetryBytes = 10;
constexpr float kWheelResolutionMps = 0.001f;

constexpr std::size_t packet_header_bytes(TeamNumber team) { return team == kNoTeamNumber ? 6 : 7; }
constexpr std::size_t packet_bytes(std::size_t robots, TeamNumber team = kNoTeamNumber) {
  return packet_header_bytes(team) + robots * kPacketRobotBytes + 2;
}

inline std::span<const std::byte> bytes_of(const Packet& packet) { return {packet.data(), packet.size()}; }

inline Status encode(const Commands& commands, std::uint8_t sequence, Packet& out, TeamNumber team = kNoTeamNumber) {
  OutgoingPackets packets;
  const Status status = encode(touchline_layout(team), commands, {commands.stop, false, sequence, {}}, packets);
  out.clear();
  if (!packets.empty()) out = packets[0].packet;
  return status;
}

inline Status decode(std::span<const std::byte> bytes, Commands& commands, std::uint8_t& sequence,
                     TeamNumber team = kNoTeamNumber) {
  ParsedPacket read;
  if (const Status status = decode_packet(touchline_layout(team), bytes, kUnknownId, read); !status.ok()) return status;
  if (read.team != team) return ErrorCode::kCorruptFrame;
  commands = read.commands;
  sequence = read.sequence;
  return {};
}

inline Packet encode_telemetry(const RobotTelemetry& telemetry) {
  Packet out;
  static_cast<void>(encode_telemetry(touchline_telemetry_layout(), telemetry, out));
  return out;
}

inline Status decode_telemetry(std::span<const std::byte> bytes, RobotTelemetry& telemetry) {
  ParsedPacket read;
  const Status status = decode_packet(touchline_telemetry_layout(), bytes, kUnknownId, read);
  if (status.ok()) telemetry = read.telemetry;
  return status;
}

/// PacketStream for command packets.
class CommandStream {
 public:
  explicit CommandStream(TeamNumber team = kNoTeamNumber) : layout_(touchline_layout(team)) {}
  CommandStream(const CommandStream&) = delete;
  CommandStream& operator=(const CommandStream&) = delete;
  ~CommandStream() = default;

  void push(std::byte byte) { stream_.push(byte); }
  bool next(Commands& commands, std::uint8_t& sequence) {
    ParsedPacket read;
    if (!stream_.next(read)) return false;
    commands = read.commands;
    sequence = read.sequence;
    return true;
  }
  void reset() { stream_.reset(); }
  [[nodiscard]] std::uint64_t skipped_bytes() const { return stream_.skipped_bytes(); }
  [[nodiscard]] std::uint64_t foreign_packets() const { return stream_.foreign_packets(); }

 private:
  PacketLayout layout_;
  PacketStream stream_{layout_};
};

/// PacketStream for telemetry.
class TelemetryStream {
 public:
  TelemetryStream() = default;
  TelemetryStream(const TelemetryStream&) = delete;
  TelemetryStream& operator=(const TelemetryStream&) = delete;
  ~TelemetryStream() = default;

  void push(std::byte byte) { stream_.push(byte); }
  bool next(RobotTelemetry& telemetry) {
    ParsedPacket read;
    if (!stream_.next(read)) return false;
    telemetry = read.telemetry;
    return true;
  }
  [[nodiscard]] std::uint64_t skipped_bytes() const { return stream_.skipped_bytes(); }

 private:
  PacketLayout layout_ = touchline_telemetry_layout();
  PacketStream stream_{layout_};
};

}  // namespace touchline
