#include "hal/files/interruption.h"

#include <poll.h>

namespace touchline::hal {
namespace {

std::atomic<const std::atomic<bool>*> interruption{nullptr};

}  // namespace

void set_interruption(const std::atomic<bool>* requested) { interruption = requested; }

bool is_interrupted() {
  const std::atomic<bool>* const requested = interruption;
  return requested != nullptr && requested->load(std::memory_order_relaxed);
}

bool wait_until_ready(int descriptor, Ready what) {
  pollfd file{descriptor, static_cast<short>(what == Ready::kRead ? POLLIN : POLLOUT), 0};
  while (!is_interrupted()) {
    if (::poll(&file, 1, static_cast<int>(kInterruptionDelay.count())) > 0) return true;
  }
  return false;
}

}  // namespace touchline::hal
