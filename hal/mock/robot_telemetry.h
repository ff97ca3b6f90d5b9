#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/radio/telemetry.h"
#include "core/time.h"
#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"

namespace touchline::hal::mock {

/// Simulates the telemetry of the robots of one side (docs/radio.md) and the link that carries it: packets are delayed,
/// lost, corrupted or truncated. It uses its own random stream, so receiving telemetry does not change the game.
class RobotTelemetrySource {
 public:
  RobotTelemetrySource(const ArenaParameters& parameters, std::uint64_t seed, Side side = Side::kOwn);

  /// Sets how robots write their reports.
  void set_layout(const PacketLayout& layout) { layout_ = layout; }
  /// Records that a command packet was due at robot `id`. `good`: it was received and valid.
  void on_packet(int id, bool good);
  /// Records the wheel speeds that robot `id` drives; the battery voltage sags with them.
  void on_wheel_speeds(int id, const WheelSpeeds& wheels);
  /// Sends all reports that are due until `now`, and receives those that have arrived.
  void advance(Instant now);
  /// Sets what the encoders of robot `id` measure.
  void measure(int id, const WheelSpeeds& wheels);
  /// Moves the oldest received bytes into `into`; returns their number. If reports do not name their robots, all bytes
  /// are those of robot `id`.
  std::size_t read(std::span<std::byte> into, int& id);
  std::size_t read(std::span<std::byte> into) {
    int id = 0;
    return read(into, id);
  }
  /// Returns whether reports contain ids or addresses.
  [[nodiscard]] bool names_robots() const { return layout_.names_robots(); }

 private:
  struct Robot {
    int id = 0;
    Instant next{};  // time of the next report
    std::uint8_t sequence = 0;
    float battery_v = 0.0f, speed_mps = 0.0f, link = 1.0f;
    WheelSpeeds measured;
  };
  struct PacketInFlight {
    Instant arrival{};
    int id = 0;
    Packet packet;
  };
  struct ReceivedBytes {
    int id = 0;
    std::size_t count = 0;
  };

  void send_report(Robot& robot, Instant now);
  void append_received(const PacketInFlight& in_flight);
  Robot* find(int id);

  ChannelParameters parameters_;
  PacketLayout layout_ = touchline_telemetry_layout();
  Random random_;
  FixedVector<Robot, kMaxRobots> robots_;
  // This is enough for five robots at 50 Hz with one second of delay. A packet that does not fit is lost.
  FixedVector<PacketInFlight, 256> in_flight_;
  FixedVector<std::byte, 4096> received_;           // as large as the kernel's serial buffer
  FixedVector<ReceivedBytes, 4096> received_from_;  // whose bytes these are, oldest first
  Instant begin_{};
  bool begun_ = false;
};

}  // namespace touchline::hal::mock
