#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/fixed_vector.h"
#include "core/status.h"
#include "core/types.h"
#include "hal/result.h"

namespace touchline::hal {

/// A line that transmits bytes. No call blocks.
class ByteLine {
 public:
  ByteLine() = default;
  ByteLine(const ByteLine&) = delete;
  ByteLine& operator=(const ByteLine&) = delete;
  virtual ~ByteLine() = default;
  /// Returns the number of bytes that the driver has accepted and not sent yet.
  virtual Result<std::size_t> unsent_bytes() = 0;
  /// Accepts as many bytes as fit, beginning with the first; returns their number, which may be 0.
  virtual Result<std::size_t> write(std::span<const std::byte> bytes) = 0;
};

/// Sends packets over a line that may be slower than the rate of packets. Only the newest command of a receiver is
/// useful: the driver gets a packet when it has sent all earlier bytes. Until then one packet per receiver waits here,
/// and a newer packet replaces that of the same receiver, so no queue builds up. Robots are served in turn, so each of
/// them waits for one packet of each other robot at most. A packet for all robots goes first and replaces those that
/// wait for single robots, because their commands are older. A packet that the driver has accepted in part is completed
/// first: the robots never get a part of a packet followed by another packet.
class PacketSlot {
 public:
  /// Accepts the packet unless the line fails. kBusy: the packet was accepted and replaced an older one.
  Result<void> send(const Packet& packet, std::size_t receiver, ByteLine& line);
  /// Passes waiting bytes to the driver if it can accept them.
  Result<void> serve(ByteLine& line);
  /// Drops waiting bytes.
  void clear();

  /// During ByteLine::write(): who gets the packet that these bytes begin.
  [[nodiscard]] std::size_t receiver() const { return receiver_; }
  /// Number of bytes that the driver has not accepted yet.
  [[nodiscard]] std::size_t bytes() const;
  /// Number of packets that the driver accepted in several parts.
  [[nodiscard]] std::uint64_t split_packets() const { return split_packets_; }

 private:
  /// The receiver whose packet is the next one; nullopt: none waits.
  [[nodiscard]] std::optional<std::size_t> next_receiver() const;

  std::array<Packet, kMaxReceivers> waiting_;  // by receiver; empty: none waits
  std::size_t next_robot_ = 0;                 // the robot after the one that was served last
  std::array<std::byte, kMaxPacketBytes>
      partly_sent_{};  // end of a packet of which the driver has accepted the beginning
  std::size_t unsent_begin_ = 0, unsent_end_ = 0;
  std::size_t receiver_ = kAllRobots;
  std::uint64_t split_packets_ = 0;
};

}  // namespace touchline::hal
