#include "firmware/stop_signal.h"

#include <ctime>

#include <csignal>
#include <cstdint>

namespace touchline {
namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not lock");

std::atomic<std::int64_t> requested_at_s{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal handler may not lock");

// timeout(1), service managers and terminals send the same signal to the process and to its group, so that it comes
// twice: the second one must not take the stop packets away.
constexpr std::int64_t kPatience_s = 2;

void request_stop(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (!stop_requested.exchange(true, std::memory_order_relaxed)) {
    requested_at_s.store(now.tv_sec, std::memory_order_relaxed);
  } else if (now.tv_sec - requested_at_s.load(std::memory_order_relaxed) > kPatience_s) {
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return stop_requested;
}

}  // namespace touchline
