#pragma once

#include <algorithm>

#include "core/time.h"

namespace touchline::network {

/// Limits the rate of messages (token bucket): short bursts pass, a flood does not.
class MessageLimit {
 public:
  explicit MessageLimit(double rate_hz) : rate_hz_(rate_hz), burst_(std::max(10.0, rate_hz * kBurstS)), left_(burst_) {}

  /// Whether a message that arrives at `now` may pass.
  [[nodiscard]] bool pass(Instant now) {
    if (now > last_) {
      left_ = std::min(burst_, left_ + seconds(now - last_) * rate_hz_);
      last_ = now;
    }
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  // A team sends the commands of its robots at once, and a receiver that was late finds several frames of them.
  static constexpr double kBurstS = 0.1;

  double rate_hz_, burst_, left_;
  Instant last_{};
};

}  // namespace touchline::network
