#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/radio/packet_stream.h"
#include "firmware/arena_objects.h"
#include "firmware/arena_sides.h"
#include "firmware/config/configuration.h"
#include "hal/fnv1a.h"
#include "hal/mock/arena.h"
#include "tools/programs/arena/control_port.h"
#include "tools/programs/arena/robot_port.h"

namespace touchline::arena {

/// The bytes that came for the robots.
struct PacketCounters {
  std::uint64_t packets = 0;
  std::uint64_t missing = 0;        // gaps in the sequence numbers: lost on the way
  std::uint64_t damaged_bytes = 0;  // that are no part of a packet
  std::uint64_t silent_frames = 0;  // in lock-step: no packet followed them in time
};

/// A game of the arena whose own robots are driven through a port, by another program.
class ServedGame {
 public:
  /// The line before the robots is real, so the simulated one takes no time.
  /// kUnsupported: the packets do not tell for which robot they are; errors of make_opponents().
  Result<void> make(const config::Configuration& configuration, std::uint64_t seed);

  [[nodiscard]] hal::mock::Arena& arena() { return *arena_; }
  [[nodiscard]] const PacketCounters& counters() const { return counters_; }
  /// Hands all packets that have arrived at `port` to the robots, at the arena's time. Errors of RobotPort::receive().
  Result<void> take_packets(RobotPort& port);
  /// Carries out what other programs want of the arena.
  void take_requests(ControlPort& port) { port.serve(objects_); }
  /// Sends what the robots have sent.
  void send_telemetry(RobotPort& port);
  void count_frame() { ++frames_; }
  void count_silent_frame() { ++counters_.silent_frames; }
  /// Returns the result of the game, several lines. The hash is that of all packets, each with the number of frames
  /// before it.
  [[nodiscard]] std::string summary() const;

 private:
  void take(std::span<const std::byte> bytes, bool keeps_packets);
  void count(const ParsedPacket& packet);
  void pass_on(std::span<const std::byte> packet);

  ArenaOpponents opponents_;  // before the arena, which refers to them
  std::unique_ptr<hal::mock::Arena> arena_;
  ArenaObjects objects_;  // after the arena, to which they refer
  PacketLayout layout_;
  PacketStream stream_;
  Packet pending_;  // received since the last complete packet
  std::optional<std::uint8_t> last_sequence_;
  PacketCounters counters_;
  hal::Fnv1a hash_;
  std::uint64_t frames_ = 0;
};

}  // namespace touchline::arena
