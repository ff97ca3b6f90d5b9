#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::latency {

/// Stops the kernel's tracing when a frame took too long, so that the trace ends with what happened in that frame, as
/// `cyclictest --breaktrace` does. Somebody else starts and reads the trace (trace-cmd, perf, rtla).
class KernelTrace {
 public:
  KernelTrace() = default;
  ~KernelTrace();
  KernelTrace(const KernelTrace&) = delete;
  KernelTrace& operator=(const KernelTrace&) = delete;

  /// `limit`: from capture to packet. `folder`: where tracefs is mounted. kNotFound, kPermission: it is not there, or
  /// only root may stop tracing.
  Result<void> open(Duration limit, const std::string& folder = "/sys/kernel/tracing");
  /// Stops tracing at the first frame that exceeds the limit; writes its number and time into the trace before. Never
  /// allocates. Does nothing before open().
  void check(std::uint64_t number, Duration latency);
  /// The frame at which tracing was stopped; 0: none.
  [[nodiscard]] std::uint64_t stopped_at() const { return stopped_at_; }

 private:
  int tracing_on_ = -1, marker_ = -1;
  Duration limit_{};
  std::uint64_t stopped_at_ = 0;
};

}  // namespace touchline::latency
