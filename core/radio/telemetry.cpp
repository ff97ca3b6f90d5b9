#include "core/radio/telemetry.h"

#include <algorithm>

#include "core/radio/packet_encoder.h"

namespace touchline {
namespace {

// Number of consecutive packets; 1.5 seconds at two per second.
constexpr std::uint8_t kRequiredPackets = 3;
// Rise that shows a replaced battery. When the motors are off, a battery recovers by only 0.1 to 0.2 V.
constexpr float kReplacedBatteryV = 0.3f;

}  // namespace

Status encode_telemetry(const PacketLayout& layout, const RobotTelemetry& telemetry, Packet& out) {
  RobotValues robot;
  robot.id = telemetry.id;
  robot.battery_v = telemetry.battery_v;
  robot.link_percent = telemetry.link_percent;
  robot.wheels = telemetry.wheels.value_or(WheelSpeeds{});
  PacketValues values;
  values.sequence = telemetry.sequence;
  return encode_packet(layout, {&robot, 1}, values, out);
}

void RobotMonitor::configure(const PacketLayout& layout, float low_battery_v) {
  low_battery_v_ = low_battery_v;
  layout_ = layout;
  finders_.fill(PacketFinder(layout_));
  contradictions_.fill(0);
}

void RobotMonitor::listen(std::span<const std::byte> bytes, Instant now, RobotReports& reports, std::size_t sender) {
  if (layout_.fields.empty()) return;
  const bool is_shared = layout_.names_robots() || sender >= kAllRobots;
  PacketFinder& finder = finders_[is_shared ? kAllRobots : sender];
  ParsedPacket packet;
  for (const std::byte byte : bytes) {
    finder.push(byte);
    while (finder.next(packet, readings_)) process(packet, sender, now, reports);
  }
  reports.foreign_bytes = 0;
  for (const PacketFinder& each : finders_) reports.foreign_bytes += each.skipped_bytes();
  reports.report_bytes = largest_packet(layout_, 1);
}

RobotId RobotMonitor::sender_id(std::size_t sender) const {
  const auto& receivers = layout_.receivers;
  if (receivers.size() == 1) return receivers[0].id;
  return sender < receivers.size() ? receivers[sender].id : kUnknownId;
}

void RobotMonitor::process(const ParsedPacket& packet, std::size_t sender, Instant now, RobotReports& reports) {
  RobotTelemetry telemetry = packet.telemetry;
  if (!layout_.names_robots()) telemetry.id = sender_id(sender);
  if (telemetry.id < 0) return;
  auto& robots = reports.robots;
  ++reports.packets;
  std::size_t at = 0;
  while (at < robots.size() && robots[at].last.id < telemetry.id) ++at;
  if (at == robots.size() || robots[at].last.id != telemetry.id) {
    if (!robots.push_back({})) return;
    std::move_backward(robots.begin() + at, robots.end() - 1, robots.end());
    robots[at] = {};
    robots[at].last.id = telemetry.id;
    robots[at].last.sequence = static_cast<std::uint8_t>(telemetry.sequence - 1);
  }
  RobotReport& report = robots[at];
  const auto step = static_cast<std::uint8_t>(telemetry.sequence - report.last.sequence);
  if (packet.has_sequence) {
    if (step == 0) return;                        // repeated by the radio module
    if (step <= 127) report.missed += step - 1U;  // otherwise the robot restarted, or the packet is out of order
  }
  ++report.packets;
  report.last = telemetry;
  report.heard = now;
  update_battery_state(report);
}

void RobotMonitor::update_battery_state(RobotReport& report) {
  const float battery_v = report.last.battery_v;
  if (low_battery_v_ <= 0.0f || battery_v <= 0.0f) return;
  const bool contradicts =
      report.battery_low ? battery_v > low_battery_v_ + kReplacedBatteryV : battery_v < low_battery_v_;
  const auto index = static_cast<std::uint8_t>(report.last.id);
  std::uint8_t& count = contradictions_[index];
  count = contradicts ? static_cast<std::uint8_t>(count + 1) : std::uint8_t{0};
  if (count < kRequiredPackets) return;
  report.battery_low = !report.battery_low;
  count = 0;
}

}  // namespace touchline
