#include "hal/linux/monotonic_clock.h"

#include <cerrno>
#include <ctime>

namespace touchline::hal {

namespace {

Instant read_clock(clockid_t clock) {
  std::timespec time{};
  ::clock_gettime(clock, &time);  // cannot fail: the clock exists and the address is valid
  return Instant(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

}  // namespace

Instant MonotonicClock::read() { return read_clock(CLOCK_MONOTONIC); }

Instant MonotonicClock::read_with_suspension() { return read_clock(CLOCK_BOOTTIME); }

void MonotonicClock::wait_for(Instant instant) {
  const auto since_zero = instant.time_since_epoch();
  if (since_zero.count() <= 0) return;
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(since_zero);
  std::timespec time{};
  time.tv_sec = static_cast<std::time_t>(whole.count());
  time.tv_nsec = static_cast<long>((since_zero - whole).count());
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

}  // namespace touchline::hal
