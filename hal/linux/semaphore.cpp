#include "hal/linux/semaphore.h"

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace touchline::hal {

Semaphore::Semaphore() { ::sem_init(&count_, 0, 0); }  // cannot fail for a count of zero within one process
Semaphore::~Semaphore() { ::sem_destroy(&count_); }

void Semaphore::post() noexcept { ::sem_post(&count_); }

void Semaphore::wait() noexcept {
  while (::sem_wait(&count_) != 0) {  // EINTR
  }
}

bool Semaphore::wait_until(Instant deadline) noexcept {
  const auto since_zero = std::max(deadline.time_since_epoch(), Duration::zero());
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(since_zero);
  std::timespec time{};
  time.tv_sec = static_cast<std::time_t>(whole.count());
  time.tv_nsec = static_cast<long>((since_zero - whole).count());
  while (::sem_clockwait(&count_, CLOCK_MONOTONIC, &time) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

}  // namespace touchline::hal
