#include "core/radio/packet_stream.h"

namespace touchline {

std::size_t PacketStream::Format::length(std::span<const std::byte> bytes) {
  // Each test uses only bytes that have arrived. A packet whose first bytes are valid may still become complete.
  if (bytes[0] != kPacketMagic0) return kNoPacket;
  if (bytes.size() > 1 && bytes[1] != kPacketMagic1) return kNoPacket;
  if (bytes.size() > 2 && bytes[2] != kPacketVersion) return kNoPacket;
  if (bytes.size() < kPacketHeaderBytes) return kMoreBytes;
  const std::size_t count = std::to_integer<std::size_t>(bytes[5]);
  return count > kMaxRobotsPerTeam ? kNoPacket : packet_bytes(count);
}

bool PacketStream::next(Commands& commands, std::uint8_t& sequence) {
  return sync_.next([&](std::span<const std::byte> bytes) { return decode(bytes, commands, sequence).ok(); });
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
