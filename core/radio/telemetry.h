#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/radio/packet_sync.h"
#include "core/types.h"

// Telemetry packet of a robot, byte by byte (docs/radio.md):
//   'T' 'R' | version | id | sequence | battery uint16, mV | link, percent | CRC uint16
// Numbers of two bytes are little endian.
namespace touchline {

constexpr std::byte kTelemetryMagic0{0x54}, kTelemetryMagic1{0x52};  // "TR"
constexpr std::byte kTelemetryVersion{1};
constexpr std::size_t kTelemetryBytes = 10;
/// Value of the link byte if the robot does not measure its reception.
constexpr std::byte kTelemetryNoLink{0xFF};
using TelemetryPacket = std::array<std::byte, kTelemetryBytes>;

/// Encodes a packet as a robot does. Voltages are rounded to 1 mV and saturated at 0 and 65.535 V. The id must not be
/// negative, and the link at most 100.
TelemetryPacket encode_telemetry(const RobotTelemetry& telemetry);

/// kCorruptFrame: wrong length, start, version, checksum, id or percentage; `telemetry` is unchanged then.
Status decode_telemetry(std::span<const std::byte> bytes, RobotTelemetry& telemetry);

/// Finds telemetry packets in the bytes of a line.
class TelemetryStream {
 public:
  void push(std::byte byte) { sync_.push(byte); }
  /// Returns the oldest complete packet. False if more bytes are needed.
  bool next(RobotTelemetry& telemetry);
  void reset() { sync_.reset(); }
  [[nodiscard]] std::uint64_t skipped_bytes() const { return sync_.skipped_bytes(); }

 private:
  struct Format {
    static constexpr std::size_t kMaxBytes = kTelemetryBytes;
    static std::size_t length(std::span<const std::byte> bytes);
  };
  PacketSync<Format> sync_;
};

/// Keeps the last telemetry of each robot, and detects low batteries.
class RobotMonitor {
 public:
  /// A battery is low after three consecutive packets below `low_battery_v`, because a starting motor lowers the
  /// voltage for a moment. It is good again (replaced) after three that are 0.3 V above. 0 disables the detection.
  void configure(float low_battery_v);
  /// Processes received bytes at time `now`; the work is proportional to their number. Robots beyond the capacity are
  /// not listed; `reports.robots.overflow()` counts their packets.
  void listen(std::span<const std::byte> bytes, Instant now, RobotReports& reports);

 private:
  void process(const RobotTelemetry& telemetry, Instant now, RobotReports& reports);
  void update_battery_state(RobotReport& report);

  TelemetryStream stream_;
  float low_battery_v_ = 0.0f;
  // By id: number of consecutive packets that contradict the current state of the battery.
  std::array<std::uint8_t, 128> contradictions_{};
};

}  // namespace touchline
