#include "core/radio/packet_stream.h"

#include <algorithm>

namespace touchline {

void PacketStream::push(std::byte byte) {
  if (size_ == buffer_.size()) {
    drop(1);
    ++skipped_;
  }
  buffer_[size_++] = byte;
}

bool PacketStream::next(Commands& commands, std::uint8_t& sequence) {
  std::size_t begin = 0;
  bool found = false;
  std::size_t length = 0;
  for (; begin < size_; ++begin) {
    const std::span<const std::byte> rest{buffer_.data() + begin, size_ - begin};
    // Each test asks for what has come only: a packet whose beginning fits so far may still become one.
    if (rest[0] != kPacketMagic0) continue;
    if (rest.size() > 1 && rest[1] != kPacketMagic1) continue;
    if (rest.size() > 2 && rest[2] != kPacketVersion) continue;
    if (rest.size() < kPacketHeaderBytes) break;
    const std::size_t count = std::to_integer<std::size_t>(rest[5]);
    if (count > kMaxRobotsPerTeam) continue;
    length = packet_bytes(count);
    if (rest.size() < length) break;
    found = decode(rest.first(length), commands, sequence).ok();
    if (found) break;
  }
  skipped_ += begin;
  drop(found ? begin + length : begin);
  return found;
}

void PacketStream::reset() {
  skipped_ += size_;
  size_ = 0;
}

void PacketStream::drop(std::size_t count) {
  std::copy(buffer_.data() + count, buffer_.data() + size_, buffer_.data());
  size_ -= count;
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
