#pragma once

#include <sys/types.h>

#include <string>

namespace touchline::latency {

/// stress-ng beside the measurement, on all processors, with ordinary priority: arithmetic on each processor, one
/// process that thrashes the caches, one that fills and checks 128 MiB of memory, one that writes files of 16 MiB and
/// reads them back. Ends with this object, and with this process, however that ends. From the thread that lives
/// longest, before it becomes privileged.
class BackgroundLoad {
 public:
  BackgroundLoad() = default;
  ~BackgroundLoad() { static_cast<void>(stop()); }
  BackgroundLoad(const BackgroundLoad&) = delete;
  BackgroundLoad& operator=(const BackgroundLoad&) = delete;

  /// Takes a second, after which the load is there. `program`: another one only in tests.
  bool start(std::string& error, const std::string& program = "stress-ng");
  /// False: it had ended by itself.
  bool stop();
  /// The command line.
  [[nodiscard]] static std::string description();

 private:
  pid_t process_ = -1;
};

}  // namespace touchline::latency
