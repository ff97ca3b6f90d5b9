#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace touchline {

/// Instead of a packet's length.
constexpr std::size_t kNoPacket = 0, kMoreBytes = ~std::size_t{0};

/// Finds packets in the last `N` bytes of a line that loses, inserts and corrupts bytes.
///
/// After any error, the first complete packet is found as soon as the bytes that a corrupt header announced have
/// arrived: the search continues after the invalid start bytes, not after the invalid packet.
template <std::size_t N>
class PacketSync {
 public:
  /// If the buffer is full because next() was not called, the oldest byte is dropped and counted as skipped.
  void push(std::byte byte) {
    if (size_ == buffer_.size()) {
      drop(1);
      ++skipped_;
    }
    buffer_[size_++] = byte;
  }

  /// Calls take(bytes) for possible packets, oldest first, until it returns true. False if more bytes are needed.
  /// `length_at(bytes)`: length of the packet at the start of `bytes`, which are never empty; kMoreBytes: not known
  /// yet; kNoPacket: these bytes do not start a packet.
  template <class LengthAt, class Take>
  bool next(LengthAt length_at, Take take) {
    std::size_t begin = 0, length = 0;
    bool found = false;
    for (; begin < size_; ++begin) {
      const std::span<const std::byte> rest{buffer_.data() + begin, size_ - begin};
      length = length_at(rest);
      if (length == kNoPacket) continue;
      if (length == kMoreBytes || rest.size() < length) break;
      found = take(rest.first(length));
      if (found) break;
    }
    skipped_ += begin;
    drop(found ? begin + length : begin);
    return found;
  }

  /// Removes all bytes, which are one packet or are skipped.
  template <class LengthAt, class Take>
  bool take_all(LengthAt length_at, Take take) {
    const std::span<const std::byte> bytes{buffer_.data(), size_};
    const bool found = !bytes.empty() && length_at(bytes) == size_ && take(bytes);
    if (!found) skipped_ += size_;
    size_ = 0;
    return found;
  }

  /// Drops the buffered bytes and counts them as skipped.
  void reset() {
    skipped_ += size_;
    size_ = 0;
  }

  /// Number of bytes that were not part of a valid packet.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return skipped_; }

 private:
  void drop(std::size_t count) {
    std::copy(buffer_.data() + count, buffer_.data() + size_, buffer_.data());
    size_ -= count;
  }

  std::array<std::byte, N> buffer_{};
  std::size_t size_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace touchline
