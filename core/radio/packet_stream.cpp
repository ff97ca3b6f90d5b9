#include "core/radio/packet_stream.h"

namespace touchline {

void PacketFinder::push(std::byte byte) {
  switch (frames_.push(byte)) {
    case FrameReader::Event::kNone:
      return;
    case FrameReader::Event::kBegin:
      sync_.reset();
      [[fallthrough]];
    case FrameReader::Event::kByte:
      // Whoever did not call next() has lost the complete packet before this byte.
      if (frame_complete_) sync_.reset();
      frame_complete_ = false;
      sync_.push(frames_.byte());
      return;
    case FrameReader::Event::kEnd:
      frame_complete_ = true;
      return;
    case FrameReader::Event::kDrop:
      sync_.reset();
      return;
  }
}

bool PacketFinder::next(ParsedPacket& packet, FieldReadings& readings) {
  bool is_own = false;
  const auto length = [&](std::span<const std::byte> bytes) { return parse_packet(*layout_, bytes, readings); };
  // A foreign packet is valid too: its bytes are not searched for another one.
  const auto take = [&](std::span<const std::byte>) {
    ParsedPacket read;
    if (!decode_packet(*layout_, readings, receiver_, read).ok()) return false;
    is_own = read.team == layout_->team;
    if (is_own) packet = read;
    return true;
  };
  if (layout_->framing == Framing::kCobs || layout_->framing == Framing::kSlip) {
    if (!frame_complete_) return false;
    frame_complete_ = false;
    if (sync_.take_all(length, take) && !is_own) ++foreign_packets_;
    return is_own;
  }
  while (sync_.next(length, take)) {
    if (is_own) return true;
    ++foreign_packets_;
  }
  return false;
}

void PacketFinder::reset() {
  sync_.reset();
  frames_.reset();
  frame_complete_ = false;
}

bool SequenceFilter::obey(std::uint8_t sequence, bool stop) {
  const auto step = static_cast<std::uint8_t>(sequence - last_);
  const bool is_new = !last_known_ || (step >= 1 && step <= 127);
  if (is_new) {
    last_ = sequence;
    last_known_ = true;
  }
  return is_new || stop;
}

}  // namespace touchline
