#include "core/radio/telemetry.h"

#include <algorithm>
#include <cmath>

#include "core/radio/wire_format.h"

namespace touchline {
namespace {

constexpr std::size_t kCrcAt = kTelemetryBytes - 2;
constexpr float kVoltsPerStep = 0.001f;
// Number of consecutive packets; 1.5 seconds at two per second.
constexpr std::uint8_t kRequiredPackets = 3;
// Rise that shows a replaced battery. When the motors are off, a battery recovers by only 0.1 to 0.2 V.
constexpr float kReplacedBatteryV = 0.3f;

std::uint16_t battery_steps(float battery_v) {
  if (!(battery_v > 0.0f)) return 0;
  return static_cast<std::uint16_t>(std::min(std::lround(std::min(battery_v, 100.0f) / kVoltsPerStep), 65535L));
}

}  // namespace

TelemetryPacket encode_telemetry(const RobotTelemetry& telemetry) {
  TelemetryPacket out{kTelemetryMagic0, kTelemetryMagic1, kTelemetryVersion, static_cast<std::byte>(telemetry.id),
                      static_cast<std::byte>(telemetry.sequence)};
  const std::uint16_t battery = battery_steps(telemetry.battery_v);
  out[5] = low_byte(battery);
  out[6] = high_byte(battery);
  out[7] = telemetry.link_percent < 0 ? kTelemetryNoLink : static_cast<std::byte>(telemetry.link_percent);
  const std::uint16_t crc = crc16_ccitt_false(std::span(out).first(kCrcAt));
  out[kCrcAt] = low_byte(crc);
  out[kCrcAt + 1] = high_byte(crc);
  return out;
}

Status decode_telemetry(std::span<const std::byte> bytes, RobotTelemetry& telemetry) {
  if (bytes.size() != kTelemetryBytes) return ErrorCode::kCorruptFrame;
  if (bytes[0] != kTelemetryMagic0 || bytes[1] != kTelemetryMagic1) return ErrorCode::kCorruptFrame;
  if (bytes[2] != kTelemetryVersion) return ErrorCode::kCorruptFrame;
  const auto id = std::to_integer<unsigned>(bytes[3]);
  const auto link = std::to_integer<unsigned>(bytes[7]);
  if (id > 127 || (link > 100 && bytes[7] != kTelemetryNoLink)) return ErrorCode::kCorruptFrame;
  if (crc16_ccitt_false(bytes.first(kCrcAt)) != uint16_at(bytes, kCrcAt)) return ErrorCode::kCorruptFrame;
  telemetry.id = static_cast<RobotId>(id);
  telemetry.sequence = std::to_integer<std::uint8_t>(bytes[4]);
  telemetry.battery_v = static_cast<float>(uint16_at(bytes, 5)) * kVoltsPerStep;
  telemetry.link_percent = link > 100 ? kLinkUnknown : static_cast<std::int8_t>(link);
  return {};
}

std::size_t TelemetryStream::Format::length(std::span<const std::byte> bytes) {
  if (bytes[0] != kTelemetryMagic0) return kNoPacket;
  if (bytes.size() > 1 && bytes[1] != kTelemetryMagic1) return kNoPacket;
  if (bytes.size() > 2 && bytes[2] != kTelemetryVersion) return kNoPacket;
  return kTelemetryBytes;
}

bool TelemetryStream::next(RobotTelemetry& telemetry) {
  return sync_.next([&](std::span<const std::byte> bytes) { return decode_telemetry(bytes, telemetry).ok(); });
}

void RobotMonitor::configure(float low_battery_v) {
  low_battery_v_ = low_battery_v;
  stream_.reset();
  contradictions_.fill(0);
}

void RobotMonitor::listen(std::span<const std::byte> bytes, Instant now, RobotReports& reports) {
  RobotTelemetry telemetry;
  for (const std::byte byte : bytes) {
    stream_.push(byte);
    while (stream_.next(telemetry)) process(telemetry, now, reports);
  }
  reports.foreign_bytes = stream_.skipped_bytes();
}

void RobotMonitor::process(const RobotTelemetry& telemetry, Instant now, RobotReports& reports) {
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
  if (step == 0) return;                        // repeated by the radio module
  if (step <= 127) report.missed += step - 1U;  // otherwise the robot restarted, or the packet is out of order
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
