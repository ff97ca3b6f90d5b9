#pragma once

#include <semaphore.h>

#include "core/time.h"

namespace touchline::hal {

/// Counts what one thread has ready for another; waiting ends at an instant. Neither call allocates; post() never
/// blocks.
class Semaphore {
 public:
  Semaphore();
  ~Semaphore();
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  void post() noexcept;
  void wait() noexcept;
  /// False: nothing came before `deadline` (of hal::Clock).
  [[nodiscard]] bool wait_until(Instant deadline) noexcept;

 private:
  sem_t count_;
};

}  // namespace touchline::hal
