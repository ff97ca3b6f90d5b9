#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::latency {

/// Stops the kernel's tracing if a frame took too long, so that the trace ends with the events of that frame, as
/// `cyclictest --breaktrace` does. The user starts and reads the trace with another program (trace-cmd, perf, rtla).
class KernelTrace {
 public:
  KernelTrace() = default;
  ~KernelTrace();
  KernelTrace(const KernelTrace&) = delete;
  KernelTrace& operator=(const KernelTrace&) = delete;

  /// `limit`: from capture to packet. `folder`: where tracefs is mounted. kNotFound: tracefs is not mounted;
  /// kPermission: only root may stop tracing.
  Result<void> open(Duration limit, const std::string& folder = "/sys/kernel/tracing");
  /// Stops tracing at the first frame that exceeds the limit, after writing the frame's number and time into the trace.
  /// Never allocates. Does nothing before open().
  void check(std::uint64_t number, Duration latency);
  /// Returns the number of the frame at which tracing was stopped; 0: none.
  [[nodiscard]] std::uint64_t stopped_at() const { return stopped_at_; }

 private:
  int tracing_on_ = -1, marker_ = -1;
  Duration limit_{};
  std::uint64_t stopped_at_ = 0;
};

}  // namespace touchline::latency
