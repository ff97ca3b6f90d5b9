#include "tools/programs/latency/progress.h"

#include <unistd.h>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>

namespace touchline::latency {
namespace {

constexpr auto kInterval = std::chrono::milliseconds(250);

void show(const std::stop_token& stop, const Measurement& measurement, std::size_t steps) {
  std::mutex mutex;
  std::condition_variable_any changed;
  std::unique_lock lock(mutex);
  while (!changed.wait_for(lock, stop, kInterval, [&] { return stop.stop_requested(); })) {
    if (steps > 0) {
      std::fprintf(stderr, "\r%zu of %zu frames", measurement.seen(), steps);
    } else {
      std::fprintf(stderr, "\r%zu frames", measurement.seen());
    }
  }
  std::fputs("\r\x1b[K", stderr);  // clears the line for the report
}

}  // namespace

Progress::Progress(const Measurement& measurement, std::size_t steps) {
  if (::isatty(STDERR_FILENO) == 0) return;
  thread_ = std::jthread([&measurement, steps](const std::stop_token& stop) { show(stop, measurement, steps); });
}

}  // namespace touchline::latency
