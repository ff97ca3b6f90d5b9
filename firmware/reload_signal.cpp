#include "firmware/reload_signal.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <csignal>

namespace touchline {
namespace {

std::atomic<std::uint32_t> requests{0};
std::atomic<bool> ends_with_terminal{false};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free, "a signal handler may not lock");

bool has_terminal() {
  const int file = ::open("/dev/tty", O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file >= 0) ::close(file);
  return file >= 0;
}

void request_reload(int /*signal*/) {
  const int interrupted = errno;
  if (ends_with_terminal.load(std::memory_order_relaxed) && !has_terminal()) {
    static_cast<void>(std::raise(SIGTERM));
  } else {
    requests.fetch_add(1, std::memory_order_relaxed);
  }
  errno = interrupted;
}

}  // namespace

const std::atomic<std::uint32_t>& reload_on_signal() {
  struct sigaction former {};
  sigaction(SIGHUP, nullptr, &former);
  ends_with_terminal.store(former.sa_handler != SIG_IGN && has_terminal(), std::memory_order_relaxed);
  struct sigaction action {};
  action.sa_handler = request_reload;
  action.sa_flags = SA_RESTART;
  sigaction(SIGHUP, &action, nullptr);
  return requests;
}

}  // namespace touchline
