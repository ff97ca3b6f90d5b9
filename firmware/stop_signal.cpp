#include "firmware/stop_signal.h"

#include <csignal>
#include <cstdint>

#include "hal/linux/monotonic_clock.h"

namespace touchline {
namespace {

std::atomic<bool> stop_requested{false};
std::atomic<Duration::rep> first_request{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<Duration::rep>::is_always_lock_free,
              "a signal handler may not lock");

void request_stop(int signal) {
  const Duration::rep now = hal::MonotonicClock::read().time_since_epoch().count();
  if (!stop_requested.exchange(true, std::memory_order_relaxed)) {
    first_request.store(now, std::memory_order_relaxed);
  } else if (Duration(now - first_request.load(std::memory_order_relaxed)) >= kInsistence) {
    std::signal(signal, SIG_DFL);
    static_cast<void>(std::raise(signal));  // taken when this handler returns
  }
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  struct sigaction at_hang_up {};
  sigaction(SIGHUP, nullptr, &at_hang_up);
  if (at_hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return stop_requested;
}

}  // namespace touchline
