#pragma once

#include <sys/types.h>

#include <string>

#include "hal/result.h"

namespace touchline::latency {

/// Runs stress-ng during the measurement with ordinary priority. It computes on each processor; one process thrashes
/// the caches, one fills and checks 128 MiB of memory, and one writes files of 16 MiB and reads them back. stress-ng
/// ends with this object, or with this process, however the process ends. Start it from the main thread, because the
/// kernel ends it with the thread that started it. Start it before that thread gets real-time priority, which it would
/// inherit.
class BackgroundLoad {
 public:
  BackgroundLoad() = default;
  ~BackgroundLoad() { static_cast<void>(stop()); }
  BackgroundLoad(const BackgroundLoad&) = delete;
  BackgroundLoad& operator=(const BackgroundLoad&) = delete;

  /// Starts the load; blocks for one second until it runs. kNotFound: the program is not installed; kIo: it cannot be
  /// started, or it ended immediately. `program` is replaced by tests.
  Result<void> start(const std::string& program = "stress-ng");
  /// Stops the load. Returns false if the load had already ended.
  bool stop();
  /// Returns the command line of the load.
  [[nodiscard]] static std::string description();

 private:
  pid_t process_ = -1;
};

}  // namespace touchline::latency
