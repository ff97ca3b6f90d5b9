#pragma once

#include <atomic>
#include <cstdint>

namespace touchline {

/// Holds counters that show other threads that the loop is running.
struct LoopHeartbeat {
  std::atomic<std::uint64_t> iterations{0};
  std::atomic<std::uint64_t> good_frames{0};
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "the loop must not wait");

}  // namespace touchline
