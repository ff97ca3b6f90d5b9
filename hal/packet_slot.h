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

/// The driver below a packet slot. No call blocks.
class ByteLine {
 public:
  ByteLine() = default;
  ByteLine(const ByteLine&) = delete;
  ByteLine& operator=(const ByteLine&) = delete;
  virtual ~ByteLine() = default;
  /// Bytes that the driver holds and has not yet sent.
  virtual Result<std::size_t> waiting() = 0;
  /// Takes as many of the first bytes as it has room for, maybe none.
  virtual Result<std::size_t> write(std::span<const std::byte> bytes) = 0;
};

/// Sends packets over a line that may be slower than they come. Commands are perishable: the driver gets a packet only
/// when it holds nothing any more; until then one packet waits here, and a newer one takes its place. So what goes out
/// is always the newest there is, and no queue grows. What the driver has begun to take is completed before anything
/// else: the receiver never sees half a packet followed by another.
class PacketSlot {
 public:
  /// Takes the packet in any case but an error of the line. kBusy: an older packet was dropped for it.
  Result<void> send(const Packet& packet, ByteLine& line);
  /// Moves on what waits.
  Result<void> serve(ByteLine& line);
  /// Forgets it.
  void clear();

  /// Bytes that the driver has not taken yet.
  [[nodiscard]] std::size_t bytes() const { return rest_end_ - rest_begin_ + held_.size(); }
  /// Packets that the driver took in more than one piece.
  [[nodiscard]] std::uint64_t split_packets() const { return split_packets_; }

 private:
  Packet held_;                                    // none of it is on its way
  std::array<std::byte, kMaxPacketBytes> rest_{};  // of a packet that the driver took only a part of
  std::size_t rest_begin_ = 0, rest_end_ = 0;
  std::uint64_t split_packets_ = 0;
};

}  // namespace touchline::hal
