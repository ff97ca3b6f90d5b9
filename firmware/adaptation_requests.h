#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include "core/adaptation.h"

namespace touchline {

/// Counts requests to the adaptation to the light. Any thread may increment a counter, once for each request.
struct AdaptationRequests {
  std::atomic<std::uint32_t> freeze{0};  // toggles between frozen and following the light
  std::atomic<std::uint32_t> reset{0};   // toggles between the calibrated state and following the light
};

/// Serves each request once.
class AdaptationRequestReader {
 public:
  /// Returns the mode after the requests since the last call; `mode` is the mode before them.
  AdaptationMode serve(const AdaptationRequests& requests, AdaptationMode mode) {
    if (is_new(requests.freeze, freezes_)) mode = toggled(mode, AdaptationMode::kFrozen);
    if (is_new(requests.reset, resets_)) mode = toggled(mode, AdaptationMode::kOff);
    return mode;
  }

 private:
  static bool is_new(const std::atomic<std::uint32_t>& count, std::uint32_t& served) {
    const std::uint32_t now = count.load(std::memory_order_relaxed);
    return std::exchange(served, now) != now;
  }
  static AdaptationMode toggled(AdaptationMode mode, AdaptationMode other) {
    return mode == other ? AdaptationMode::kFollow : other;
  }

  std::uint32_t freezes_ = 0, resets_ = 0;
};

}  // namespace touchline
