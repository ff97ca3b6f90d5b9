#pragma once

#include <string>

#include "core/time.h"

namespace touchline::hal {

/// Relation of CLOCK_MONOTONIC, the clock of all time stamps, to Unix time.
struct UnixTimeOffset {
  Duration offset{};       // Unix time minus CLOCK_MONOTONIC
  Duration uncertainty{};  // uncertainty of the offset, because both clocks cannot be read at the same instant
  bool synchronized = false;
  Duration clock_error{};  // the kernel's bound of the difference to UTC; only valid if synchronized

  [[nodiscard]] Duration to_unix(Instant monotonic) const { return monotonic.time_since_epoch() + offset; }
};

/// Reads both clocks in turn several times, and keeps the closest pair. Takes some microseconds.
UnixTimeOffset measure_unix_time_offset();

/// Returns whether somebody has set the clock: the offset has changed by more than both uncertainties.
bool differ(const UnixTimeOffset& before, const UnixTimeOffset& now);

/// Returns text such as "Unix time = monotonic time + 1763850000.123456 s, +- 0.04 us; the clock is synchronized within
/// 1.2 ms".
std::string describe(const UnixTimeOffset& offset);
/// Returns text such as "Unix time +1763850000.123456 s +-0.04 us", for a status line.
std::string short_text(const UnixTimeOffset& offset);

}  // namespace touchline::hal
