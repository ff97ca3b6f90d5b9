#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

/// Sends packets over a line that may be slower than the rate of packets. Because only the newest command is useful,
/// the driver gets a packet only when it has sent all earlier bytes. Until then one packet waits here, and a newer one
/// replaces it, so no queue builds up. A packet that the driver has accepted in part is completed first: the receiver
/// never gets a part of a packet followed by another packet.
class PacketSlot {
 public:
  /// Accepts the packet unless the line fails. kBusy: the packet was accepted and replaced an older one.
  Result<void> send(const Packet& packet, ByteLine& line);
  /// Passes waiting bytes to the driver if it can accept them.
  Result<void> serve(ByteLine& line);
  /// Drops waiting bytes.
  void clear();

  /// Returns the number of bytes that the driver has not accepted yet.
  [[nodiscard]] std::size_t bytes() const { return unsent_end_ - unsent_begin_ + waiting_.size(); }
  /// Returns the number of packets that the driver accepted in several parts.
  [[nodiscard]] std::uint64_t split_packets() const { return split_packets_; }

 private:
  Packet waiting_;                                        // packet that waits for the line
  std::array<std::byte, kMaxPacketBytes> partly_sent_{};  // rest of a packet whose beginning the driver has accepted
  std::size_t unsent_begin_ = 0, unsent_end_ = 0;
  std::uint64_t split_packets_ = 0;
};

}  // namespace touchline::hal
