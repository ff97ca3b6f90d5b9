#include "firmware/signals.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <csignal>
#include <initializer_list>

#include "firmware/adaptation_requests.h"
#include "firmware/crash_stop.h"
#include "hal/linux/monotonic_clock.h"

namespace touchline {
namespace {

std::atomic<bool> stop_requested{false};
std::atomic<Duration::rep> first_stop_request{0};
std::atomic<std::uint32_t> reload_requests{0};
std::atomic<bool> ends_with_terminal{false};
AdaptationRequests adaptation_requests;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<Duration::rep>::is_always_lock_free &&
                  std::atomic<std::uint32_t>::is_always_lock_free,
              "a signal handler must not lock");

void on_stop_signal(int signal) {
  const Duration::rep now = hal::MonotonicClock::read().time_since_epoch().count();
  if (!stop_requested.exchange(true, std::memory_order_relaxed)) {
    first_stop_request.store(now, std::memory_order_relaxed);
  } else if (Duration(now - first_stop_request.load(std::memory_order_relaxed)) >= kForcedExitDelay) {
    crash_stop::send_stop_packets();
    std::signal(signal, SIG_DFL);
    static_cast<void>(std::raise(signal));  // delivered when this handler returns
  }
}

bool has_terminal() {
  const int file = ::open("/dev/tty", O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file >= 0) ::close(file);
  return file >= 0;
}

void on_hang_up(int /*signal*/) {
  const int interrupted_errno = errno;
  if (ends_with_terminal.load(std::memory_order_relaxed) && !has_terminal()) {
    static_cast<void>(std::raise(SIGTERM));
  } else {
    reload_requests.fetch_add(1, std::memory_order_relaxed);
  }
  errno = interrupted_errno;
}

void on_adaptation_signal(int signal) {
  auto& requests = signal == SIGUSR1 ? adaptation_requests.freeze : adaptation_requests.reset;
  requests.fetch_add(1, std::memory_order_relaxed);
}

void install(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction current {};
  sigaction(signal, nullptr, &current);
  return current.sa_handler == SIG_IGN;
}

}  // namespace

const std::atomic<bool>& handle_stop_signals() {
  for (const int signal : {SIGINT, SIGTERM}) install(signal, on_stop_signal);
  if (!is_ignored(SIGHUP)) install(SIGHUP, on_stop_signal);
  std::signal(SIGPIPE, SIG_IGN);
  return stop_requested;
}

const std::atomic<std::uint32_t>& handle_reload_signal() {
  ends_with_terminal.store(!is_ignored(SIGHUP) && has_terminal(), std::memory_order_relaxed);
  install(SIGHUP, on_hang_up);
  return reload_requests;
}

AdaptationRequests& handle_adaptation_signals() {
  for (const int signal : {SIGUSR1, SIGUSR2}) install(signal, on_adaptation_signal);
  return adaptation_requests;
}

}  // namespace touchline
