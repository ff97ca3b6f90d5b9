#include "core/radio/framing.h"

namespace touchline {
namespace {

constexpr std::byte kSlipEnd{0xC0}, kSlipEscape{0xDB}, kSlipEscapedEnd{0xDC}, kSlipEscapedEscape{0xDD};
constexpr std::byte kXbeeStart{0x7E}, kXbeeEscape{0x7D}, kXbeeFlip{0x20};
constexpr std::size_t kCobsBlock = 254;

bool needs_xbee_escape(std::byte byte) {
  return byte == kXbeeStart || byte == kXbeeEscape || byte == std::byte{0x11} || byte == std::byte{0x13};
}

void add_cobs(const Packet& from, Packet& out) {
  std::size_t begin = 0;
  for (;;) {
    std::size_t end = begin;
    while (end < from.size() && end - begin < kCobsBlock && from[end] != std::byte{0}) ++end;
    out.push_back(static_cast<std::byte>(end - begin + 1));
    for (std::size_t i = begin; i < end; ++i) out.push_back(from[i]);
    if (end == from.size()) break;
    begin = end - begin == kCobsBlock ? end : end + 1;
  }
  out.push_back(std::byte{0});
}

void add_slip(const Packet& from, Packet& out) {
  out.push_back(kSlipEnd);
  for (const std::byte byte : from) {
    if (byte == kSlipEnd || byte == kSlipEscape) {
      out.push_back(kSlipEscape);
      out.push_back(byte == kSlipEnd ? kSlipEscapedEnd : kSlipEscapedEscape);
    } else {
      out.push_back(byte);
    }
  }
  out.push_back(kSlipEnd);
}

void add_xbee(const Packet& from, Packet& out) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const bool escaped = i > 0 && needs_xbee_escape(from[i]);
    if (escaped) out.push_back(kXbeeEscape);
    out.push_back(escaped ? from[i] ^ kXbeeFlip : from[i]);
  }
}

}  // namespace

bool add_framing(Framing framing, Packet& packet) {
  if (framing == Framing::kNone) return true;
  const Packet from = packet;
  packet.clear();
  if (framing == Framing::kCobs) {
    add_cobs(from, packet);
  } else if (framing == Framing::kSlip) {
    add_slip(from, packet);
  } else {
    add_xbee(from, packet);
  }
  return packet.overflow() == 0;
}

FrameReader::Event FrameReader::push(std::byte byte) {
  byte_ = byte;
  switch (framing_) {
    case Framing::kNone:
      return Event::kByte;
    case Framing::kCobs:
      return push_cobs(byte);
    case Framing::kSlip:
      if (byte == kSlipEnd) return Event::kEnd;
      if (byte == kSlipEscape) {
        escaped_ = true;
        return Event::kNone;
      }
      if (escaped_) byte_ = byte == kSlipEscapedEnd ? kSlipEnd : kSlipEscape;
      escaped_ = false;
      return Event::kByte;
    case Framing::kXbee:
      if (byte == kXbeeStart) {
        escaped_ = false;
        return Event::kBegin;
      }
      if (byte == kXbeeEscape) {
        escaped_ = true;
        return Event::kNone;
      }
      if (escaped_) byte_ = byte ^ kXbeeFlip;
      escaped_ = false;
      return Event::kByte;
  }
  return Event::kNone;
}

// Each block begins with the number of its bytes and 1; less than 255 of them say that a zero follows the block, unless
// the packet ends there.
FrameReader::Event FrameReader::push_cobs(std::byte byte) {
  if (byte == std::byte{0}) {
    const bool whole = left_ == 0;
    left_ = 0;
    zero_follows_ = false;
    return whole ? Event::kEnd : Event::kDrop;
  }
  if (left_ > 0) {
    --left_;
    return Event::kByte;
  }
  const bool zero = zero_follows_;
  left_ = std::to_integer<unsigned>(byte) - 1u;
  zero_follows_ = left_ < kCobsBlock;
  byte_ = std::byte{0};
  return zero ? Event::kByte : Event::kNone;
}

}  // namespace touchline
