#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/status.h"
#include "core/time.h"
#include "firmware/latency_histogram.h"
#include "firmware/loop_report.h"
#include "hal/camera.h"

namespace touchline {

inline constexpr std::size_t kErrorCodeCount = static_cast<std::size_t>(ErrorCode::kStopped) + 1;

/// Counts what other programs and the referee sent.
struct ExternalCounts {
  std::uint64_t commands = 0;          // commands for single robots
  std::uint64_t commands_expired = 0;  // times that a robot stopped because its last command was too old
  std::uint64_t referee_messages = 0;
};

/// Counts since the start of the loop, in fixed memory.
struct LoopStatistics {
  Instant begin{}, end{};
  std::uint64_t frames = 0;         // frames processed by the pipeline
  std::uint64_t good_frames = 0;    // frames of these that were readable and fresh enough
  std::uint64_t frames_lost = 0;    // gaps in the driver's sequence numbers
  std::uint64_t future_stamps = 0;  // frames stamped later than their arrival; the time of arrival is used
  std::uint64_t overloads = 0;      // frames that exceeded some capacity
  std::uint64_t runs_dropped = 0, regions_dropped = 0;
  std::uint64_t packets = 0;          // packets accepted by the radio
  std::uint64_t packets_dropped = 0;  // accepted packets that a newer one replaced before they were sent
  std::uint64_t packets_refused = 0;
  std::uint64_t packets_unreachable = 0;  // packets of these that the network did not pass on to their receiver
  std::uint64_t stop_packets = 0;         // accepted packets that stop all robots
  ExternalCounts external;
  hal::SourceCounters source;         // packets of a source of poses that were not used
  std::optional<Score> score;         // score from the referee or the arena; nullopt: neither reports it
  bool own_on_positive_half = false;  // if true, the own team plays towards negative x
  std::array<std::array<std::uint64_t, kErrorCodeCount>, kDeviceCount> faults{};
  std::array<std::uint64_t, kDeviceCount> reopened{};
  RobotReports robots;       // telemetry of the robots
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
