#pragma once

#include "core/time.h"
#include "firmware/console/messages.h"

namespace touchline::console {

/// Measures processor time, memory and temperature of this program's computer.
class MachineMonitor {
 public:
  /// Call it about once a second.
  void measure(Instant now);
  [[nodiscard]] const MachineStatus& status() const { return status_; }

 private:
  Instant measured_{};
  double cpu_s_ = 0.0;
  MachineStatus status_;
};

}  // namespace touchline::console
