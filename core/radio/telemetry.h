#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/radio/packet_sync.h"
#include "core/types.h"

// What robots send back, byte by byte (docs/radio.md):
//   'T' 'R' | version | id | sequence | battery uint16, mV | link, percent | CRC uint16
// Numbers of two bytes are little endian.
namespace touchline {

constexpr std::byte kTelemetryMagic0{0x54}, kTelemetryMagic1{0x52};  // "TR"
constexpr std::byte kTelemetryVersion{1};
constexpr std::size_t kTelemetryBytes = 10;
/// In the place of a percentage: the robot does not count what it hears.
constexpr std::byte kTelemetryNoLink{0xFF};
using TelemetryPacket = std::array<std::byte, kTelemetryBytes>;

/// What a robot does. Voltages are rounded to 1 mV and saturated at 0 and 65.535 V. The id must be 0 or more, the link
/// at most 100.
TelemetryPacket encode_telemetry(const RobotTelemetry& telemetry);

/// kCorruptFrame: wrong length, start, version, checksum, id or percentage; nothing is changed then.
Status decode_telemetry(std::span<const std::byte> bytes, RobotTelemetry& telemetry);

/// Bytes in, robots' words out, whatever else is on the line.
class TelemetryStream {
 public:
  void push(std::byte byte) { sync_.push(byte); }
  /// The oldest whole packet among the bytes pushed; false: more bytes are needed.
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

/// Keeps the last word of each robot, and judges their batteries.
class RobotMonitor {
 public:
  /// A battery is low after three words in a row below `low_battery_v` (a motor that starts pulls the voltage down for
  /// a moment), and good again after three that are 0.3 V above: it was changed. 0: none is ever low.
  void configure(float low_battery_v);
  /// Bytes as they came, at `now`. Work is bounded by their number. A robot beyond the capacity is not listed;
  /// `reports.robots.overflow()` counts its words.
  void listen(std::span<const std::byte> bytes, Instant now, RobotReports& reports);

 private:
  void note(const RobotTelemetry& telemetry, Instant now, RobotReports& reports);
  void judge_battery(RobotReport& report);

  TelemetryStream stream_;
  float low_battery_v_ = 0.0f;
  // By id: words in a row that speak against what is believed of the battery.
  std::array<std::uint8_t, 128> doubts_{};
};

}  // namespace touchline
