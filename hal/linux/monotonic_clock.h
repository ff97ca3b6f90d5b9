#pragma once

#include "hal/clock.h"

namespace touchline::hal {

/// CLOCK_MONOTONIC, the clock of V4L2's time stamps. Neither call allocates.
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] Instant now() const override { return read(); }
  /// Sleeps until an absolute time, so that repeated sleeps do not drift. Signals do not end the sleep.
  void sleep_until(Instant instant) override { wait_for(instant); }

  /// Static versions, as Pipeline::StageClock needs them.
  [[nodiscard]] static Instant read();
  static void wait_for(Instant instant);
  /// Reads CLOCK_BOOTTIME, which includes the time during which the system was suspended.
  [[nodiscard]] static Instant read_with_suspension();
};

}  // namespace touchline::hal
