#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/radio/packet_stream.h"
#include "core/status.h"
#include "core/time.h"
#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"
#include "hal/mock/robot_telemetry.h"

namespace touchline::hal::mock {

class World;

/// Packets as the robots heard them; a packet that two robots should hear counts twice.
struct ChannelStatistics {
  std::uint64_t sent = 0;
  std::uint64_t due = 0;        // sent x own robots, of those that have arrived by now
  std::uint64_t obeyed = 0;     // good, newer than the last
  std::uint64_t lost = 0;       // not heard at all
  std::uint64_t corrupted = 0;  // heard and thrown away: the checksum was wrong
  std::uint64_t ignored = 0;    // good, but older than what was known
  std::uint64_t timeouts = 0;   // times that a robot stopped because it heard nothing
};

/// Serial line, air and the robots' ends of docs/radio.md: bytes leave at the line's speed, a packet arrives after
/// delay and jitter (so one may overtake another), each robot may miss it or get it with wrong bits; each robot looks
/// for packets in its bytes, checks them, obeys or stands still after the time-out.
class RadioChannel {
 public:
  /// `baud` of the line: 10 bits a byte.
  RadioChannel(const ArenaParameters& parameters, int baud, std::uint64_t seed);

  /// kBusy: the line's queue is full, nothing was taken. kOutOfRange: no bytes, or more than a packet has.
  Status send(std::span<const std::byte> bytes, Instant now);
  /// When the last byte handed over has left.
  [[nodiscard]] Instant drained() const { return line_free_; }
  /// Of the bytes handed over, those that have not left.
  [[nodiscard]] std::size_t waiting_bytes(Instant now) const;
  /// What robots have sent back until now: the oldest bytes, which are gone then.
  std::size_t receive(std::span<std::byte> into) { return telemetry_.read(into); }
  /// Lets everything happen that is due until `now`; the robots' wheels are told to `world`.
  void deliver(Instant now, World& world);
  [[nodiscard]] const ChannelStatistics& statistics() const { return statistics_; }

 private:
  struct Flying {
    Instant arrival{};
    Packet packet;
  };
  struct Receiver {
    int id = 0;
    PacketStream stream;
    SequenceFilter filter;
    Instant last_good{};
    bool timed_out = true;  // at the start it stands
  };

  void hear(Receiver& receiver, const Packet& packet, Instant now, World& world);

  ChannelParameters parameters_;
  Duration byte_time_, timeout_;
  Random random_;
  Instant line_free_{};
  // At 60 packets a second, a second of delay and a second of mean jitter, 120 on average.
  FixedVector<Flying, 256> flying_;
  FixedVector<Receiver, kMaxRobots> receivers_;
  RobotTelemetrySource telemetry_;
  ChannelStatistics statistics_;
};

}  // namespace touchline::hal::mock
