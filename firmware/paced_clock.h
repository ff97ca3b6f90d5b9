#pragma once

#include <optional>

#include "hal/clock.h"
#include "hal/linux/monotonic_clock.h"

namespace touchline {

/// Slows simulated time down to real time: before the simulation jumps ahead, the thread sleeps for the length of the
/// jump. The simulated instants, and so all results of the simulation, are the same as without this clock.
class PacedClock final : public hal::Clock {
 public:
  explicit PacedClock(hal::Clock& simulated) : simulated_(simulated) {}

  [[nodiscard]] Instant now() const override { return simulated_.now(); }
  void sleep_until(Instant instant) override {
    const Instant machine_now = hal::MonotonicClock::read();
    if (!offset_) offset_ = machine_now - simulated_.now();
    // Largest lag behind real time that is caught up. A longer lag, for example after the computer was suspended, is
    // kept.
    constexpr Duration kLargestLag = std::chrono::milliseconds(500);
    if (const Duration lag = machine_now - (instant + *offset_); lag > kLargestLag) *offset_ += lag;
    hal::MonotonicClock::wait_for(instant + *offset_);
    simulated_.sleep_until(instant);
  }

 private:
  hal::Clock& simulated_;
  std::optional<Duration> offset_;  // CLOCK_MONOTONIC minus simulated time
};

}  // namespace touchline
