#pragma once

#include <optional>

#include "hal/clock.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/mock/arena.h"

namespace touchline {

/// Slows simulated time down to a multiple of real time: before the simulation jumps ahead, the thread sleeps for the
/// length of the jump. The simulated instants, and so all results of the simulation, are the same as without this
/// clock.
class PacedClock final : public hal::Clock {
 public:
  /// `pace`: its speed is that of the clock; it must outlive the clock.
  PacedClock(hal::Clock& simulated, const hal::mock::ArenaPace& pace) : simulated_(simulated), pace_(pace) {}

  [[nodiscard]] Instant now() const override { return simulated_.now(); }
  void sleep_until(Instant instant) override {
    const Instant machine_now = hal::MonotonicClock::read();
    const double speed = pace_.speed();
    if (!begin_ || begin_->speed != speed) begin_ = Begin{simulated_.now(), machine_now, speed};
    Instant due = begin_->machine + from_seconds(seconds(instant - begin_->simulated) / speed);
    // Largest lag behind real time that is caught up. A longer lag, for example after the computer was suspended or the
    // arena was paused, is kept.
    constexpr Duration kLargestLag = std::chrono::milliseconds(500);
    if (const Duration lag = machine_now - due; lag > kLargestLag) {
      begin_->machine += lag;
      due = machine_now;
    }
    hal::MonotonicClock::wait_for(due);
    simulated_.sleep_until(instant);
  }

 private:
  // From here on, the simulated time passes at this speed.
  struct Begin {
    Instant simulated{}, machine{};
    double speed = 1.0;
  };

  hal::Clock& simulated_;
  const hal::mock::ArenaPace& pace_;
  std::optional<Begin> begin_;
};

}  // namespace touchline
