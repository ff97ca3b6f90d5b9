#pragma once

#include "core/time.h"

namespace touchline::hal {

/// The one time line: CLOCK_MONOTONIC on a real board, the arena's virtual time in a simulation.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual Instant now() const = 0;
  /// A virtual clock jumps.
  virtual void sleep_until(Instant instant) = 0;
};

}  // namespace touchline::hal
