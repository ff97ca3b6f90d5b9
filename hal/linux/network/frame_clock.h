#pragma once

#include <algorithm>
#include <chrono>

#include "hal/clock.h"
#include "hal/linux/monotonic_clock.h"

namespace touchline::hal {

/// The time of a receiver in lock-step: it passes with the frames, and stands still while the processor works. Without
/// a connection nobody waits for the receiver, and the time passes as fast as the machine's, so that pauses before a
/// device is reopened stay pauses. Only the loop's thread may use it.
class FrameClock final : public Clock {
 public:
  [[nodiscard]] Instant now() const override { return now_; }
  void sleep_until(Instant instant) override {
    if (instant <= now_) return;
    if (!is_driven_) MonotonicClock::wait_for(MonotonicClock::read() + (instant - now_));
    now_ = instant;
  }
  /// Advances to a frame, or to the end of a wait for it.
  void advance_to(Instant instant) { now_ = std::max(now_, instant); }
  /// Frames drive the time.
  void set_driven(bool is_driven) { is_driven_ = is_driven; }

 private:
  // Not 0, so that times before the first frame exist.
  Instant now_{std::chrono::seconds(1)};
  bool is_driven_ = false;
};

}  // namespace touchline::hal
