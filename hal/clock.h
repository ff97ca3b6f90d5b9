#pragma once

#include "core/time.h"

namespace touchline::hal {

/// The clock of all time stamps: CLOCK_MONOTONIC on a real board, virtual time in a simulation.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual Instant now() const = 0;
  /// A virtual clock advances to `instant` immediately.
  virtual void sleep_until(Instant instant) = 0;
};

}  // namespace touchline::hal
