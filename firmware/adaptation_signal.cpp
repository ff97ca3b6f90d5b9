#include "firmware/adaptation_signal.h"

#include <csignal>
#include <initializer_list>

namespace touchline {
namespace {

AdaptationRequests requests;
static_assert(std::atomic<std::uint32_t>::is_always_lock_free, "a signal handler may not lock");

void request(int signal) {
  (signal == SIGUSR1 ? requests.freeze : requests.put_back).fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

const AdaptationRequests& adaptation_on_signals() {
  struct sigaction action {};
  action.sa_handler = request;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGUSR1, SIGUSR2}) sigaction(signal, &action, nullptr);
  return requests;
}

}  // namespace touchline
