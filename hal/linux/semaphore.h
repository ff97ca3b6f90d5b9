#pragma once

#include <semaphore.h>

#include "core/time.h"

namespace touchline::hal {

/// A counting semaphore between threads, with a timeout. Neither call allocates; post() never blocks.
class Semaphore {
 public:
  Semaphore();
  ~Semaphore();
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  void post() noexcept;
  void wait() noexcept;
  /// Returns false if the time reached `deadline` (of hal::Clock).
  [[nodiscard]] bool wait_until(Instant deadline) noexcept;

 private:
  sem_t count_;
};

}  // namespace touchline::hal
