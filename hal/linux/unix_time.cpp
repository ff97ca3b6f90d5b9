#include "hal/linux/unix_time.h"

#include <sys/timex.h>
#include <array>
#include <cstdio>
#include <ctime>

#include "hal/linux/monotonic_clock.h"

namespace touchline::hal {
namespace {

Duration read_unix_time() {
  std::timespec time{};
  ::clock_gettime(CLOCK_REALTIME, &time);  // cannot fail: the clock exists and the address is valid
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

UnixTimeOffset measure_unix_time_offset() {
  // One pair of readings that no interrupt has separated is enough.
  constexpr int kAttempts = 16;
  UnixTimeOffset best;
  best.uncertainty = Duration::max();
  for (int i = 0; i < kAttempts; ++i) {
    const Instant before = MonotonicClock::read();
    const Duration unix_time = read_unix_time();
    const Instant after = MonotonicClock::read();
    const Duration half = (after - before) / 2;
    if (half >= best.uncertainty) continue;
    best.uncertainty = half;
    best.offset = unix_time - (before + half).time_since_epoch();
  }
  timex kernel{};
  best.synchronized = ::adjtimex(&kernel) != TIME_ERROR;
  if (best.synchronized) best.clock_error = std::chrono::microseconds(kernel.maxerror);
  return best;
}

bool differ(const UnixTimeOffset& before, const UnixTimeOffset& now) {
  return std::chrono::abs(now.offset - before.offset) > before.uncertainty + now.uncertainty;
}

std::string describe(const UnixTimeOffset& offset) {
  std::array<char, 160> text{};
  const int size = std::snprintf(text.data(), text.size(), "Unix time = monotonic time + %.6f s, +- %.2f us; ",
                                 seconds(offset.offset), seconds(offset.uncertainty) * 1e6);
  std::string out(text.data(), static_cast<std::size_t>(size));
  if (!offset.synchronized) return out + "the clock is not synchronized (docs/network.md)";
  std::snprintf(text.data(), text.size(), "the clock is synchronized within %.1f ms",
                seconds(offset.clock_error) * 1e3);
  return out + text.data();
}

std::string short_text(const UnixTimeOffset& offset) {
  std::array<char, 80> text{};
  const int size = std::snprintf(text.data(), text.size(), "Unix time +%.6f s +-%.2f us", seconds(offset.offset),
                                 seconds(offset.uncertainty) * 1e6);
  return {text.data(), static_cast<std::size_t>(size)};
}

}  // namespace touchline::hal
