#include "firmware/snapshot_ring.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <climits>
#include <cstring>
#include <ctime>

// The thread sanitizer does not model fences, and gcc warns about them. The thread sanitizer needs no fence here,
// because all words are atomic.
#if defined(__SANITIZE_THREAD__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wtsan"
#endif

namespace touchline {

void SnapshotRing::write(const Snapshot& snapshot) noexcept {
  const std::uint64_t index = written_.load(std::memory_order_relaxed);
  Slot& slot = slots_[index % kSlots];
  slot.version.store(2 * index + 1, std::memory_order_relaxed);
  // The fence ensures that a reader that sees one of the new words also sees the odd version.
  std::atomic_thread_fence(std::memory_order_release);
  const auto* bytes = reinterpret_cast<const unsigned char*>(&snapshot);
  for (std::size_t i = 0; i < kWords; ++i) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + i * sizeof(word), sizeof(word));
    slot.words[i].store(word, std::memory_order_relaxed);
  }
  slot.version.store(2 * index + 2, std::memory_order_release);
  written_.store(index + 1, std::memory_order_release);
  wake_readers();
}

void SnapshotRing::wake_readers() noexcept {
  // The order is sequentially consistent, as in wait(), so that either the reader sees the new count or this thread
  // sees the reader.
  wake_count_.fetch_add(1, std::memory_order_seq_cst);
  if (waiting_.load(std::memory_order_seq_cst) == 0) return;
  ::syscall(SYS_futex, &wake_count_, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
}

bool SnapshotRing::copy(std::uint64_t index, Snapshot& out) const noexcept {
  const Slot& slot = slots_[index % kSlots];
  const std::uint64_t complete = 2 * index + 2;
  if (slot.version.load(std::memory_order_acquire) != complete) return false;
  auto* bytes = reinterpret_cast<unsigned char*>(&out);
  for (std::size_t i = 0; i < kWords; ++i) {
    const std::uint64_t word = slot.words[i].load(std::memory_order_relaxed);
    std::memcpy(bytes + i * sizeof(word), &word, sizeof(word));
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  return slot.version.load(std::memory_order_relaxed) == complete;
}

void SnapshotRing::wait(std::uint64_t index, Duration time_limit) noexcept {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time_limit);
  std::timespec time{};
  time.tv_sec = static_cast<std::time_t>(whole.count());
  time.tv_nsec = static_cast<long>((time_limit - whole).count());
  waiting_.fetch_add(1, std::memory_order_seq_cst);
  const std::uint32_t count = wake_count_.load(std::memory_order_seq_cst);
  if (written() <= index) ::syscall(SYS_futex, &wake_count_, FUTEX_WAIT_PRIVATE, count, &time, nullptr, 0);
  waiting_.fetch_sub(1, std::memory_order_relaxed);
}

bool SnapshotReader::read(Snapshot& out) noexcept {
  for (;;) {
    const std::uint64_t written = ring_.written();
    if (next_ == written) return false;
    const std::uint64_t oldest = written > SnapshotRing::kSlots ? written - SnapshotRing::kSlots : 0;
    if (next_ < oldest) {
      lost_ += oldest - next_;
      next_ = oldest;
    }
    const bool complete = ring_.copy(next_++, out);
    if (complete) return true;
    ++lost_;
  }
}

}  // namespace touchline
