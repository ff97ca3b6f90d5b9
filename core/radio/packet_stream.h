#pragma once

#include <cstdint>
#include <span>

#include "core/radio/framing.h"
#include "core/radio/packet_parser.h"
#include "core/radio/packet_sync.h"

namespace touchline {

/// Finds packets of a layout in the bytes of a line that loses, inserts and corrupts bytes. After any error, the first
/// complete packet is found at the latest after kMaxPacketBytes more bytes, because a corrupt header may announce that
/// many. Several finders can share the memory for the fields of a packet, which is much larger than a finder.
///
///   finder.push(byte);
///   while (finder.next(packet, readings)) ...
class PacketFinder {
 public:
  /// `receiver`: the robot that listens, for layouts without ids. Packets of other teams than layout.team are not
  /// returned. The layout must outlive the stream.
  PacketFinder() = default;
  explicit PacketFinder(const PacketLayout& layout, RobotId receiver = kUnknownId)
      : layout_(&layout), receiver_(receiver), frames_(layout.framing) {}

  /// If the buffer is full because next() was not called, the oldest byte is dropped and counted as skipped.
  void push(std::byte byte);
  /// Returns the oldest complete packet of the own team. False if more bytes are needed.
  bool next(ParsedPacket& packet, FieldReadings& readings);
  /// Drops buffered bytes. Call it after a pause on the line that is longer than a packet.
  void reset();

  /// Number of bytes that were not part of a valid packet.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return sync_.skipped_bytes(); }
  /// Number of valid packets of other teams.
  [[nodiscard]] std::uint64_t foreign_packets() const { return foreign_packets_; }

 private:
  const PacketLayout* layout_ = nullptr;
  RobotId receiver_ = kUnknownId;
  FrameReader frames_{Framing::kNone};
  PacketSync<2 * kMaxPacketBytes> sync_;  // room for two packets: a corrupt one and the next one
  bool frame_complete_ = false;
  std::uint64_t foreign_packets_ = 0;
};

/// A finder with memory of its own for the fields.
class PacketStream : public PacketFinder {
 public:
  using PacketFinder::PacketFinder;
  bool next(ParsedPacket& packet) { return PacketFinder::next(packet, readings_); }

 private:
  FieldReadings readings_;
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
