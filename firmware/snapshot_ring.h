#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/time.h"
#include "firmware/snapshot.h"

namespace touchline {

/// Passes snapshots from the loop to any number of readers, each with its own position. The loop never waits for a
/// reader: a reader that is too slow loses the oldest snapshots, and counts them.
///
/// Each slot is a sequence lock whose content consists of relaxed atomic words (H. Boehm, Can Seqlocks Get Along With
/// Programming Language Memory Models?, MSPC 2012). 370 KB: not for the stack.
class SnapshotRing {
 public:
  // Number of snapshots kept: one second at 60 frames a second, half a second at 120.
  static constexpr std::size_t kSlots = 64;

  /// Writes a snapshot; only one thread, the loop's, may call it. Copies 5.8 KB, which takes 0.3 us
  /// (tests/firmware/snapshot_ring_test.cpp), and makes one system call that does not block if a reader waits. Never
  /// allocates.
  void write(const Snapshot& snapshot) noexcept;
  /// Returns the number of snapshots that were written.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }
  /// Ends the waits of all readers, for example to end their threads.
  void wake_readers() noexcept;

 private:
  friend class SnapshotReader;
  static_assert(sizeof(Snapshot) % sizeof(std::uint64_t) == 0, "a snapshot is copied as whole words");
  static constexpr std::size_t kWords = sizeof(Snapshot) / sizeof(std::uint64_t);
  static constexpr std::size_t kCacheLine = 64;

  struct alignas(kCacheLine) Slot {
    std::atomic<std::uint64_t> version{0};  // 2n + 1 while snapshot n is written, 2n + 2 afterwards
    std::array<std::atomic<std::uint64_t>, kWords> words{};
  };

  /// Copies snapshot `index`; returns false if it is being overwritten.
  [[nodiscard]] bool copy(std::uint64_t index, Snapshot& out) const noexcept;
  void wait(std::uint64_t index, Duration time_limit) noexcept;

  std::array<Slot, kSlots> slots_{};
  alignas(kCacheLine) std::atomic<std::uint64_t> written_{0};
  std::atomic<std::uint32_t> wake_count_{0};  // value on which readers wait; it has 32 bits because it is a futex
  std::atomic<std::uint32_t> waiting_{0};     // number of readers in wait()
};

/// A reader of a SnapshotRing, for one thread. It begins with the first snapshot that is written after its creation.
class SnapshotReader {
 public:
  /// `ring` must outlive the reader.
  explicit SnapshotReader(SnapshotRing& ring) : ring_(ring), next_(ring.written()) {}

  /// Copies the oldest snapshot that was not read and is still kept. Returns false if there is no new one; then `out`
  /// has an unspecified value.
  [[nodiscard]] bool read(Snapshot& out) noexcept;
  /// Waits until there is a snapshot to read, the time has passed, or wake_readers() was called.
  void wait(Duration time_limit) noexcept { ring_.wait(next_, time_limit); }
  /// Returns the number of snapshots that were overwritten before they were read.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

 private:
  SnapshotRing& ring_;
  std::uint64_t next_;
  std::uint64_t lost_ = 0;
};

}  // namespace touchline
