#pragma once

#include <array>
#include <cstdint>

#include "core/status.h"
#include "core/time.h"
#include "firmware/latency_histogram.h"
#include "firmware/loop_report.h"

namespace touchline {

inline constexpr std::size_t kErrorCodeCount = static_cast<std::size_t>(ErrorCode::kStopped) + 1;

/// What happened since the loop began. Fixed memory.
struct LoopStatistics {
  Instant begin{}, end{};
  std::uint64_t frames = 0;         // that went through the pipeline
  std::uint64_t good_frames = 0;    // of those, the ones that could be read and were young enough
  std::uint64_t frames_lost = 0;    // gaps in the driver's count
  std::uint64_t future_stamps = 0;  // frames stamped later than their arrival, which then counts
  std::uint64_t overloads = 0;      // frames for which some capacity was reached
  std::uint64_t runs_dropped = 0, regions_dropped = 0;
  std::uint64_t packets = 0;          // taken by the radio
  std::uint64_t packets_dropped = 0;  // of those, the ones that a newer one replaced before they left
  std::uint64_t packets_refused = 0;
  std::uint64_t stop_packets = 0;  // of the packets taken, those that halt all robots
  std::array<std::array<std::uint64_t, kErrorCodeCount>, kDeviceCount> faults{};
  std::array<std::uint64_t, kDeviceCount> reopened{};
  RobotReports robots;       // what they said of themselves
  LatencyHistogram latency;  // capture to send, see StepTiming::latency

  [[nodiscard]] std::uint64_t fault_count() const {
    std::uint64_t sum = 0;
    for (const auto& device : faults) {
      for (const std::uint64_t count : device) sum += count;
    }
    return sum;
  }
};

}  // namespace touchline
