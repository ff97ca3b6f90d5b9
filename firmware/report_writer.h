#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/types.h"
#include "firmware/loop_report.h"
#include "firmware/loop_statistics.h"
#include "firmware/stop_rules.h"

namespace touchline {

/// Writes the loop's reports into the ring: changes of the halt, faults and low batteries when they happen, and the
/// status once per interval. Allocates and formats nothing.
class ReportWriter {
 public:
  ReportWriter(ReportRing& ring, Duration interval) : ring_(ring), interval_(interval) {}

  void begin(Instant now);
  /// Adds a processed frame. `trace` must be valid until the next call.
  void add_step(const StepTrace& trace, Duration latency);
  void report_halt(std::uint32_t halt, std::uint32_t stop_number, Instant now);
  /// Reports that all commanded robots have begun to stand (PictureTrace::stands), at most once in ten seconds.
  void report_standing(Instant now);
  /// Reports a fault, at most once per interval for each device and code, and only once for
  /// FaultAction::kContinueWithout. While a device is lost, a reason is reported only once. `text`: device and cause.
  void report_fault(Device device, ErrorCode code, FaultAction action, std::string_view text, Instant now);
  /// Reports robots whose battery has become low since the last call.
  void report_batteries(const RobotReports& robots, Instant now);
  /// Reports values in force that contradict the files, each once until they agree again.
  void report_drives(const DriveReports& drives, Instant now);
  void report_status_if_due(const LoopStatistics& statistics, std::uint32_t halt, std::uint32_t stop_number,
                            AdaptationMode adaptation, Instant now);
  /// Removes the device from the lost devices of the status.
  void end_loss(Device device) { lost_[static_cast<std::size_t>(device)].set({}); }

  /// Returns the last fault, without reports of reopened devices.
  [[nodiscard]] const FaultReport& last_fault() const { return last_fault_; }

 private:
  void report_drive(DriveReport::Value value, RobotId robot, const std::array<ComparedValue, 2>& compared, Instant now);
  [[nodiscard]] double elapsed_s(Instant now) const { return seconds(now - begin_); }

  ReportRing& ring_;
  const Duration interval_;
  Instant begin_{}, next_status_{}, last_status_{};
  std::uint64_t good_frames_reported_ = 0;
  LatencyHistogram latency_;  // latencies since the last status
  // Faults reported since the last status.
  std::array<std::array<bool, kErrorCodeCount>, kDeviceCount> fault_reported_{};
  bool continue_without_reported_ = false;
  std::array<ReasonText, kDeviceCount> lost_{};
  std::array<ErrorCode, kDeviceCount> lost_code_{};
  std::uint32_t halt_reported_ = kHaltNoFrames;
  std::uint32_t stop_number_reported_ = 0;
  std::optional<Instant> standing_reported_;
  std::array<bool, 128> battery_reported_{};  // flag by robot id
  std::array<bool, 128> gain_reported_{};     // the same
  bool delay_reported_ = false, lag_reported_ = false;
  const StepTrace* last_trace_ = nullptr;
  FaultReport last_fault_;
  Report report_;  // built here and copied into the ring, because it is too large for the stack
};

}  // namespace touchline
