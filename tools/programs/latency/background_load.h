#pragma once

#include <sys/types.h>

#include <string>

#include "hal/result.h"

namespace touchline::latency {

/// Runs stress-ng during the measurement with ordinary priority: arithmetic on each processor, one process that
/// thrashes the caches, one that fills and checks 128 MiB of memory, and one that writes files of 16 MiB and reads them
/// back. stress-ng ends with this object, or with this process, however the process ends. Start it from the main thread
/// (the kernel ends it with the thread that started it), before that thread gets real-time priority, which it would
/// inherit.
class BackgroundLoad {
 public:
  BackgroundLoad() = default;
  ~BackgroundLoad() { static_cast<void>(stop()); }
  BackgroundLoad(const BackgroundLoad&) = delete;
  BackgroundLoad& operator=(const BackgroundLoad&) = delete;

  /// Starts the load; blocks for one second until it runs. kNotFound: the program is not installed; kIo: it cannot be
  /// started or ended immediately. `program`: replaced by tests.
  Result<void> start(const std::string& program = "stress-ng");
  /// Stops the load. Returns false if it had ended before.
  bool stop();
  /// The command line of the load.
  [[nodiscard]] static std::string description();

 private:
  pid_t process_ = -1;
};

}  // namespace touchline::latency
