#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.h"

namespace touchline::latency {

/// Latency of a frame; frames are in the order of time.
struct FrameLateness {
  Duration latency{};             // from capture to packet
  std::uint64_t lost_before = 0;  // number of frames lost since the previous one
};

/// A stall: frames `first` to `first + delayed`.
struct StallExtent {
  std::size_t first = 0;
  std::uint64_t delayed = 0, lost = 0;
};

/// Finds stalls. A stall begins with a frame that is more than half a `period` later than `usual`, and lasts as long as
/// frames are later by more than a tenth of a period, which jitter seldom causes. Returns none if `period` is zero.
std::vector<StallExtent> find_stalls(std::span<const FrameLateness> frames, Duration usual, Duration period);

}  // namespace touchline::latency
