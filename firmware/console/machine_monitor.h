#pragma once

#include "core/time.h"
#include "firmware/console/file_thread.h"
#include "firmware/console/messages.h"

namespace touchline::console {

/// Measures processor time, memory and temperature of the computer on which this program runs. Only the console's
/// thread may use it.
class MachineMonitor {
 public:
  /// `files` reads the kernel's files, because a sensor may be slow. Its jobs do not use this object after its end.
  explicit MachineMonitor(FileThread& files) : files_(files) {}
  ~MachineMonitor() = default;
  MachineMonitor(const MachineMonitor&) = delete;
  MachineMonitor& operator=(const MachineMonitor&) = delete;

  /// Call it about once a second.
  void measure(Instant now);
  [[nodiscard]] const MachineStatus& status() const { return status_; }

 private:
  FileThread& files_;
  bool is_reading_ = false;
  Instant measured_{};
  double cpu_s_ = 0.0;
  MachineStatus status_;
};

}  // namespace touchline::console
