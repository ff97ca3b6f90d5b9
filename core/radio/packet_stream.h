#pragma once

#include <cstdint>
#include <span>

#include "core/radio/packet.h"
#include "core/radio/packet_sync.h"

namespace touchline {

/// Bytes in, packets out: the receiving end of a line that loses, adds and turns bytes. After any fault the first
/// whole packet that follows is found, as soon as the bytes that a damaged header promised have come; at most
/// packet_bytes(kMaxRobotsPerTeam).
///
///   stream.push(byte);
///   while (stream.next(commands, sequence)) ...
class PacketStream {
 public:
  /// When the caller never asks next(), the oldest byte goes (counted as skipped).
  void push(std::byte byte) { sync_.push(byte); }
  /// The oldest whole packet among the bytes pushed; false: more bytes are needed.
  bool next(Commands& commands, std::uint8_t& sequence);
  /// For a pause on the line longer than a packet: what has come so far is no packet's beginning.
  void reset() { sync_.reset(); }

  /// Bytes that belonged to no good packet.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return sync_.skipped_bytes(); }

 private:
  struct Format {
    static constexpr std::size_t kMaxBytes = packet_bytes(kMaxRobotsPerTeam);
    static std::size_t length(std::span<const std::byte> bytes);
  };
  PacketSync<Format> sync_;
};

/// Which packets a robot obeys: stop packets always, others when they are newer than the last one by 1 to 127 steps
/// of the sequence number (RFC 1982's comparison of serial numbers). So a packet repeated or overtaken on the way
/// does nothing.
class SequenceFilter {
 public:
  [[nodiscard]] bool obey(std::uint8_t sequence, bool stop);
  /// After a time-out (docs/radio.md) any number is new.
  void reset() { last_known_ = false; }

 private:
  bool last_known_ = false;
  std::uint8_t last_ = 0;
};

}  // namespace touchline
