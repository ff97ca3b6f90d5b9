#pragma once

#include <chrono>

namespace touchline {

/// Clock of all time stamps: the camera driver's monotonic clock, or the virtual clock of the mock arena. It has no
/// now(), because the core takes the time only from frames.
struct CaptureClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<CaptureClock>;
  static constexpr bool is_steady = true;
};
using Duration = CaptureClock::duration;
using Instant = CaptureClock::time_point;

constexpr double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
constexpr Duration from_seconds(double s) { return Duration(static_cast<Duration::rep>(s * 1e9)); }

}  // namespace touchline
