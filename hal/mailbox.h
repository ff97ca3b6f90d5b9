#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace touchline {

/// Passes values from one thread to another; only the newest one is kept. Both sides are wait-free: they never block,
/// allocate or call the kernel. There are three slots: one for the writer, one for the reader, and one between them,
/// which each exchanges for its own.
template <class T>
class Mailbox {
 public:
  /// Writes a value; only the writing thread may call it. A value that was not taken is replaced.
  void put(const T& value) {
    slots_[writer_] = value;
    const auto offered = static_cast<std::uint8_t>(writer_ | kIsNew);
    writer_ = static_cast<std::uint8_t>(between_.exchange(offered, std::memory_order_acq_rel) & kSlot);
  }

  /// Takes the newest value; only the reading thread may call it. Returns false if there is no new value, and `value`
  /// is unchanged.
  bool take(T& value) {
    if ((between_.load(std::memory_order_relaxed) & kIsNew) == 0) return false;
    reader_ = static_cast<std::uint8_t>(between_.exchange(reader_, std::memory_order_acq_rel) & kSlot);
    value = slots_[reader_];
    return true;
  }

 private:
  static constexpr std::uint8_t kIsNew = 4, kSlot = 3;
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);
  // On separate cache lines, so that the two threads do not contend for one.
  static constexpr std::size_t kCacheLine = 64;

  std::array<T, 3> slots_{};
  alignas(kCacheLine) std::uint8_t writer_ = 0;
  alignas(kCacheLine) std::uint8_t reader_ = 1;
  alignas(kCacheLine) std::atomic<std::uint8_t> between_{2};
};

}  // namespace touchline
