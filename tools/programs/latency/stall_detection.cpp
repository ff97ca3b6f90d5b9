#include "tools/programs/latency/stall_detection.h"

namespace touchline::latency {

std::vector<StallExtent> find_stalls(std::span<const FrameLateness> frames, Duration usual, Duration period) {
  std::vector<StallExtent> stalls;
  if (period <= Duration::zero()) return stalls;
  bool is_late = false;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Duration excess = frames[i].latency - usual;
    if (is_late) stalls.back().lost += frames[i].lost_before;
    if (is_late && excess > period / 10) {
      ++stalls.back().delayed;
      continue;
    }
    is_late = excess > period / 2;
    if (is_late) stalls.push_back({i, 0, frames[i].lost_before});
  }
  return stalls;
}

}  // namespace touchline::latency
