#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/radio/packet_stream.h"
#include "core/time.h"
#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"
#include "hal/mock/robot_telemetry.h"
#include "hal/result.h"

namespace touchline::hal::mock {

class World;

/// Packets counted per receiving robot: a packet that is sent to two robots counts twice, except in `sent`.
struct ChannelStatistics {
  std::uint64_t sent = 0;
  std::uint64_t due = 0;        // packets whose arrival time has passed, times the number of own robots
  std::uint64_t obeyed = 0;     // valid and newer than the previous valid one
  std::uint64_t lost = 0;       // not received
  std::uint64_t corrupted = 0;  // received and discarded because of a wrong checksum
  std::uint64_t ignored = 0;    // valid, but older than the previous valid one
  std::uint64_t foreign = 0;    // valid, but for another team
  std::uint64_t timeouts = 0;   // number of times that a robot stopped because it received nothing
};

/// Simulates the serial line, the radio link and the robots' receivers (docs/radio.md). Bytes leave at the baud rate. A
/// packet arrives after delay and jitter, so it can overtake another one. Each robot loses or corrupts packets
/// independently, parses the bytes, checks the packets, obeys them, and stops after the time-out.
class RadioChannel {
 public:
  /// `baud`: speed of the serial line at 10 bits per byte. `pause`: after each packet (LineTime). `side`: whose robots
  /// receive the packets.
  RadioChannel(const ArenaParameters& parameters, int baud, std::uint64_t seed, Duration pause = {},
               Side side = Side::kOwn);

  /// Sets the packets that the robots understand and send. They obey packets of the layout's team alone.
  void set_layouts(const PacketLayout& commands, const PacketLayout& telemetry);
  /// Queues one packet for `receiver`, an index of the layout's receivers, or for all robots. kBusy: the queue is full,
  /// and nothing was queued. kOutOfRange: `bytes` is empty or larger than a packet.
  Result<void> send(std::span<const std::byte> bytes, Instant now, std::size_t receiver = kAllRobots);
  /// The time at which the last queued byte will be sent.
  [[nodiscard]] Instant drained() const { return line_free_ - pause_; }
  /// The time at which the line is free for the next packet.
  [[nodiscard]] Instant line_free() const { return line_free_; }
  /// Returns the number of bytes that the line still needs time for: those that are not sent yet, and the pause.
  [[nodiscard]] std::size_t queued_bytes(Instant now) const;
  /// Moves the oldest bytes that the robots have sent into `into`; returns their number. If reports do not name their
  /// robots, `sender` is the index of the receiver that has sent them, because such robots have a port each.
  std::size_t receive(std::span<std::byte> into, std::size_t& sender);
  /// Processes all arrivals and time-outs until `now` and sets the wheel speeds of the robots in `world`.
  void deliver(Instant now, World& world);
  [[nodiscard]] const ChannelStatistics& statistics() const { return statistics_; }

 private:
  struct PacketInFlight {
    Instant arrival{};
    Packet packet;
    std::size_t receiver = kAllRobots;
  };
  struct RobotReceiver {
    int id = 0;
    PacketStream stream;
    SequenceFilter filter;
    Instant last_good{};
    bool timed_out = true;  // robots do not drive at the start
  };

  [[nodiscard]] bool is_for(const PacketInFlight& packet, const RobotReceiver& receiver) const;
  void deliver_to(RobotReceiver& receiver, const Packet& packet, Instant now, World& world);

  ChannelParameters parameters_;
  Side side_;
  PacketLayout layout_ = touchline_layout();
  Duration byte_time_, pause_, timeout_;
  Random random_;
  Instant line_free_{};
  // Packets in flight: at 60 packets per second, with one second of delay and one second of mean jitter, they are 120
  // on average.
  FixedVector<PacketInFlight, 256> in_flight_;
  std::vector<RobotReceiver> receivers_;
  RobotTelemetrySource telemetry_;
  ChannelStatistics statistics_;
};

}  // namespace touchline::hal::mock
