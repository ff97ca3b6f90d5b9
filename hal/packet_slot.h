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

/// The driver of a line for bytes. No call blocks.
class ByteLine {
 public:
  ByteLine() = default;
  ByteLine(const ByteLine&) = delete;
  ByteLine& operator=(const ByteLine&) = delete;
  virtual ~ByteLine() = default;
  /// Bytes that the driver has taken and not sent yet.
  virtual Result<std::size_t> waiting() = 0;
  /// Takes as many bytes as fit, from the first on; returns their number, which may be 0.
  virtual Result<std::size_t> write(std::span<const std::byte> bytes) = 0;
};

/// Sends packets over a line that may be slower than the packets arrive. Commands are perishable: the driver gets a
/// packet only after it has sent everything before. Until then one packet waits here, and a newer one replaces it. So
/// the newest packet is sent, and no queue grows. A packet that the driver has begun to take is completed first: the
/// receiver never gets half a packet followed by another.
class PacketSlot {
 public:
  /// Takes the packet unless the line fails. kBusy: the packet was taken, and an older one was dropped.
  Result<void> send(const Packet& packet, ByteLine& line);
  /// Gives waiting bytes to the driver if it can take them.
  Result<void> serve(ByteLine& line);
  /// Drops waiting bytes.
  void clear();

  /// Bytes that the driver has not taken yet.
  [[nodiscard]] std::size_t bytes() const { return rest_end_ - rest_begin_ + held_.size(); }
  /// Number of packets that the driver took in several pieces.
  [[nodiscard]] std::uint64_t split_packets() const { return split_packets_; }

 private:
  Packet held_;                                    // waits completely
  std::array<std::byte, kMaxPacketBytes> rest_{};  // of a packet that the driver has taken in part
  std::size_t rest_begin_ = 0, rest_end_ = 0;
  std::uint64_t split_packets_ = 0;
};

}  // namespace touchline::hal
