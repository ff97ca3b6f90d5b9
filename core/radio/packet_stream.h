#pragma once

#include <cstdint>
#include <span>

#include "core/radio/packet.h"
#include "core/radio/packet_sync.h"

namespace touchline {

/// Finds command packets in the bytes of a line that loses, inserts and corrupts bytes. After any error, the first
/// complete packet is found at the latest after kMaxCommandPacketBytes more bytes, because a corrupt header
/// may announce that many.
///
///   stream.push(byte);
///   while (stream.next(commands, sequence)) ...
class PacketStream {
 public:
  PacketStream() = default;
  /// `team`: of the robot. Packets of other teams, and packets without a team if the robot has one, are not returned.
  explicit PacketStream(TeamNumber team) : team_(team) {}

  /// If the buffer is full because next() was not called, the oldest byte is dropped and counted as skipped.
  void push(std::byte byte) { sync_.push(byte); }
  /// Returns the oldest complete packet of the own team. False if more bytes are needed.
  bool next(Commands& commands, std::uint8_t& sequence);
  /// Drops buffered bytes. Call it after a pause on the line that is longer than a packet.
  void reset() { sync_.reset(); }

  /// Number of bytes that were not part of a valid packet.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return sync_.skipped_bytes(); }
  /// Number of valid packets of other teams.
  [[nodiscard]] std::uint64_t foreign_packets() const { return foreign_packets_; }

 private:
  struct Format {
    static constexpr std::size_t kMaxBytes = kMaxCommandPacketBytes;
    static std::size_t length(std::span<const std::byte> bytes) { return packet_length(bytes); }
  };
  TeamNumber team_ = kNoTeamNumber;
  std::uint64_t foreign_packets_ = 0;
  PacketSync<Format> sync_;
};

/// Decides which packets a robot obeys: stop packets always; others if their sequence number is newer than the last one
/// by 1 to 127 (serial number arithmetic of RFC 1982). Repeated packets and packets out of order have no effect.
class SequenceFilter {
 public:
  [[nodiscard]] bool obey(std::uint8_t sequence, bool stop);
  /// After a time-out (docs/radio.md), any sequence number is accepted.
  void reset() { last_known_ = false; }

 private:
  bool last_known_ = false;
  std::uint8_t last_ = 0;
};

}  // namespace touchline
