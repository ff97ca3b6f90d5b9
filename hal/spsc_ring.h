#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace touchline {

/// A queue from one thread to one other that never blocks, allocates or calls the kernel. `N` is a power of two.
/// What does not fit is counted, not queued.
template <class T, std::size_t N>
class SpscRing {
  static_assert((N & (N - 1)) == 0);

 public:
  /// By the producing thread.
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

  /// By the consuming thread; false when there is nothing.
  bool pop(T& value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    value = slots_[head & (N - 1)];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// By any thread.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  // Apart, so that the two threads do not fight over one cache line.
  static constexpr std::size_t kCacheLine = 64;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  alignas(kCacheLine) std::atomic<std::uint64_t> dropped_{0};
  std::array<T, N> slots_{};
};

}  // namespace touchline
