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
  RobotMonitor() { finders_.fill(PacketFinder(layout_)); }
  RobotMonitor(const RobotMonitor&) = delete;
  RobotMonitor& operator=(const RobotMonitor&) = delete;
  ~RobotMonitor() = default;

  /// A battery is low after three consecutive packets below `low_battery_v`, because a starting motor lowers the
  /// voltage for a moment. It is good again (replaced) after three that are 0.3 V above. 0 disables the detection.
  /// `layout.receivers`: the robots that may report.
  void configure(const PacketLayout& layout, float low_battery_v);
  /// Processes received bytes at time `now`; the work is proportional to their number. Robots beyond the capacity are
  /// not listed; `reports.robots.overflow()` counts their packets. `sender`: index of the receiver that has sent the
  /// bytes; kAllRobots: unknown. Packets of a layout without id and address are those of the sender, or of the only
  /// receiver.
  void listen(std::span<const std::byte> bytes, Instant now, RobotReports& reports, std::size_t sender = kAllRobots);
  /// Sets what the packets depend on of the drive (PacketLayout::set_drive).
  void set_drive(double base_m, double max_wheel_speed_mps) { layout_.set_drive(base_m, max_wheel_speed_mps); }

 private:
  void process(const ParsedPacket& packet, std::size_t sender, Instant now, RobotReports& reports);
  [[nodiscard]] RobotId sender_id(std::size_t sender) const;
  void update_battery_state(RobotReport& report);

  PacketLayout layout_ = touchline_telemetry_layout();
  // By sender, so that the ends of packets are found that arrive in parts. Packets that name their robots share the
  // last one.
  std::array<PacketFinder, kMaxReceivers> finders_;
  FieldReadings readings_;
  float low_battery_v_ = 0.0f;
  // By id: number of consecutive packets that contradict the current state of the battery.
  std::array<std::uint8_t, 128> contradictions_{};
};

}  // namespace touchline
