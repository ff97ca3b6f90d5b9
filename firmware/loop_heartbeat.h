#pragma once

#include <atomic>
#include <cstdint>

namespace touchline {

/// What the loop shows of itself to a thread that watches over it.
struct LoopHeartbeat {
  std::atomic<std::uint64_t> iterations{0};
  std::atomic<std::uint64_t> good_frames{0};
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "the loop may not wait");

}  // namespace touchline
