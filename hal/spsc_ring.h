#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace touchline {

/// A lock-free queue from one thread to another. No call blocks, allocates or calls the kernel. `N` must be a power of
/// two. Values that do not fit are dropped and counted.
template <class T, std::size_t N>
class SpscRing {
  static_assert((N & (N - 1)) == 0);

 public:
  /// Adds a value; only the producing thread may call it. Returns false if the ring is full; the value is then dropped.
  bool push(const T& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_.load(std::memory_order_acquire) == N) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slots_[tail & (N - 1)] = value;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Takes the oldest value; only the consuming thread may call it. Returns false if the ring is empty.
  bool pop(T& value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    value = slots_[head & (N - 1)];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Any thread may call it.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  // On separate cache lines, so that the two threads do not contend for one.
  static constexpr std::size_t kCacheLine = 64;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  alignas(kCacheLine) std::atomic<std::uint64_t> dropped_{0};
  std::array<T, N> slots_{};
};

}  // namespace touchline
