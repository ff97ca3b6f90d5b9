#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/radio/packet_layout.h"
#include "core/radio/packet_stream.h"
#include "core/types.h"

namespace touchline {

/// Encodes telemetry as a robot does. kFull: the packet is too large.
Status encode_telemetry(const PacketLayout& layout, const RobotTelemetry& telemetry, Packet& out);

/// Keeps the last telemetry of each robot, and detects low batteries.
class RobotMonitor {
 public:
  RobotMonitor() = default;
  RobotMonitor(const RobotMonitor&) = delete;
  RobotMonitor& operator=(const RobotMonitor&) = delete;
  ~RobotMonitor() = default;

  /// A battery is low after three consecutive packets below `low_battery_v`, because a starting motor lowers the
  /// voltage for a moment. It is good again (replaced) after three that are 0.3 V above. 0 disables the detection.
  void configure(const PacketLayout& layout, float low_battery_v);
  /// Processes received bytes at time `now`; the work is proportional to their number. Robots beyond the capacity are
  /// not listed; `reports.robots.overflow()` counts their packets.
  void listen(std::span<const std::byte> bytes, Instant now, RobotReports& reports);

 private:
  void process(const ParsedPacket& packet, Instant now, RobotReports& reports);
  void update_battery_state(RobotReport& report);

  PacketLayout layout_ = touchline_telemetry_layout();
  PacketStream stream_{layout_};
  float low_battery_v_ = 0.0f;
  // By id: number of consecutive packets that contradict the current state of the battery.
  std::array<std::uint8_t, 128> contradictions_{};
};

}  // namespace touchline
