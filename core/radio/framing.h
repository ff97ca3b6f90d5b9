#pragma once

#include <cstddef>

#include "core/radio/packet_layout.h"

namespace touchline {

/// Adds the framing to the bytes of a packet. False: the result is larger than kMaxPacketBytes.
bool add_framing(Framing framing, Packet& packet);

/// Removes the framing from received bytes, one at a time.
class FrameReader {
 public:
  enum class Event : std::uint8_t {
    kNone,   // the byte belongs to the framing, or is kept for later
    kByte,   // byte() is one of the packet's
    kBegin,  // as kByte, and a new packet starts with it
    kEnd,    // a packet is complete: all bytes since the former kEnd
    kDrop    // the bytes since the former kEnd are damaged
  };

  explicit FrameReader(Framing framing) : framing_(framing) {}
  Event push(std::byte byte);
  [[nodiscard]] std::byte byte() const { return byte_; }
  void reset() { *this = FrameReader(framing_); }

 private:
  Event push_cobs(std::byte byte);

  Framing framing_;
  std::byte byte_{};
  bool escaped_ = false;
  // COBS: bytes until the next zero of the packet, and whether that zero belongs to the packet.
  unsigned left_ = 0;
  bool zero_follows_ = false;
};

}  // namespace touchline
