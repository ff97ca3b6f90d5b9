#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace touchline::recording {

/// A lock-free queue of records of different sizes from one thread to another, in memory of a fixed size. No call
/// blocks, allocates or calls the kernel. A record lies in consecutive memory, so the producer writes it in place.
class ByteRing {
 public:
  /// Takes `bytes` of memory, rounded up to a multiple of 8.
  explicit ByteRing(std::size_t bytes) : memory_((bytes + kAlignment - 1) / kAlignment * kAlignment) {}
  ~ByteRing() = default;
  ByteRing(const ByteRing&) = delete;
  ByteRing& operator=(const ByteRing&) = delete;

  [[nodiscard]] std::size_t capacity() const { return memory_.size(); }

  /// Returns the free bytes; only the producing thread may call it.
  [[nodiscard]] std::size_t free() const {
    return memory_.size() -
           static_cast<std::size_t>(tail_.load(std::memory_order_relaxed) - head_.load(std::memory_order_acquire));
  }
  /// Returns memory for a record of so many bytes; empty if there is no room. Only the producing thread may call it,
  /// and it calls commit() when the record is written.
  [[nodiscard]] std::span<std::byte> reserve(std::size_t bytes) {
    const std::size_t room = free();
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    const auto position = static_cast<std::size_t>(tail % memory_.size());
    const std::size_t needed = space_of(bytes), to_end = memory_.size() - position;
    const std::size_t skipped = needed > to_end ? to_end : 0;
    if (needed > memory_.size() || skipped + needed > room) return {};
    if (skipped > 0) set_size(position, kSkip);
    reserved_ = tail + skipped + needed;
    const std::size_t begin = skipped > 0 ? 0 : position;
    set_size(begin, bytes);
    return std::span(memory_).subspan(begin + kHeaderBytes, bytes);
  }
  void commit() { tail_.store(reserved_, std::memory_order_release); }

  /// Returns the oldest record; empty if there is none. Only the consuming thread may call it, and calls pop() when the
  /// record is no longer needed.
  [[nodiscard]] std::span<const std::byte> front() {
    while (head_.load(std::memory_order_relaxed) != tail_.load(std::memory_order_acquire)) {
      const std::uint64_t head = head_.load(std::memory_order_relaxed);
      const auto position = static_cast<std::size_t>(head % memory_.size());
      const std::uint64_t size = size_at(position);
      if (size != kSkip) return std::span(memory_).subspan(position + kHeaderBytes, static_cast<std::size_t>(size));
      head_.store(head + (memory_.size() - position), std::memory_order_release);
    }
    return {};
  }
  void pop() {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    const auto size = static_cast<std::size_t>(size_at(static_cast<std::size_t>(head % memory_.size())));
    head_.store(head + space_of(size), std::memory_order_release);
  }

 private:
  static constexpr std::size_t kAlignment = 8, kHeaderBytes = sizeof(std::uint64_t);
  static constexpr std::uint64_t kSkip = ~std::uint64_t{0};  // the rest of the memory is not used
  static constexpr std::size_t kCacheLine = 64;

  static std::size_t space_of(std::size_t bytes) {
    return kHeaderBytes + (bytes + kAlignment - 1) / kAlignment * kAlignment;
  }
  void set_size(std::size_t position, std::uint64_t size) {
    std::memcpy(memory_.data() + position, &size, sizeof(size));
  }
  [[nodiscard]] std::uint64_t size_at(std::size_t position) const {
    std::uint64_t size = 0;
    std::memcpy(&size, memory_.data() + position, sizeof(size));
    return size;
  }

  std::vector<std::byte> memory_;
  std::uint64_t reserved_ = 0;  // the tail after commit()
  // Bytes since the beginning, on separate cache lines, so that the two threads do not contend for one.
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};
  alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};
};

}  // namespace touchline::recording
