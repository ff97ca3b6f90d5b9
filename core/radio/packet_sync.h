#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace touchline {

/// Answers of a format in the place of a length.
constexpr std::size_t kNoPacket = 0, kMoreBytes = ~std::size_t{0};

/// Finds packets among the bytes of a line that loses, adds and turns them. `Format` says what a packet looks like:
///
///   static constexpr std::size_t kMaxBytes;
///   // Length of the packet that begins here; kMoreBytes: that cannot be told yet; kNoPacket: none begins here.
///   static std::size_t length(std::span<const std::byte> bytes);  // never empty
///
/// After any fault the first whole packet that follows is found, as soon as the bytes that a damaged header promised
/// have come: the search goes on behind a failed start, not behind the failed packet.
template <class Format>
class PacketSync {
 public:
  /// When the caller never asks next(), the oldest byte goes (counted as skipped).
  void push(std::byte byte) {
    if (size_ == buffer_.size()) {
      drop(1);
      ++skipped_;
    }
    buffer_[size_++] = byte;
  }

  /// Hands the oldest candidate that `decode(bytes)` accepts to it, and true; false: more bytes are needed.
  template <class Decode>
  bool next(Decode decode) {
    std::size_t begin = 0, length = 0;
    bool found = false;
    for (; begin < size_; ++begin) {
      const std::span<const std::byte> rest{buffer_.data() + begin, size_ - begin};
      length = Format::length(rest);
      if (length == kNoPacket) continue;
      if (length == kMoreBytes || rest.size() < length) break;
      found = decode(rest.first(length));
      if (found) break;
    }
    skipped_ += begin;
    drop(found ? begin + length : begin);
    return found;
  }

  /// What has come so far is no packet's beginning.
  void reset() {
    skipped_ += size_;
    size_ = 0;
  }

  /// Bytes that belonged to no good packet.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return skipped_; }

 private:
  void drop(std::size_t count) {
    std::copy(buffer_.data() + count, buffer_.data() + size_, buffer_.data());
    size_ -= count;
  }

  // Two packets: one that turns out to be damaged, and the one that comes after it.
  std::array<std::byte, 2 * Format::kMaxBytes> buffer_{};
  std::size_t size_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace touchline
