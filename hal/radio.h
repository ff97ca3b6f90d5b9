#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/types.h"
#include "hal/result.h"

namespace touchline::hal {

struct RadioCounters {
  std::uint64_t packets = 0, bytes = 0;  // taken by the radio
  std::uint64_t dropped = 0;             // of the packets taken, those that a newer one replaced before they were sent
  std::uint64_t refused = 0;             // errors
  std::uint64_t received_bytes = 0;
};

/// The link to the robots. Only open() and drain() may block, and only open() may allocate.
class Radio {
 public:
  virtual ~Radio() = default;

  Result<void> open() { return do_open(); }
  void close() { do_close(); }

  /// Hands over a packet of at least one byte. While the line is busy with an earlier one it waits, in the place of an
  /// older packet that waited: that one is dropped, which kBusy tells; the new packet is taken all the same.
  /// kDisconnected, kIo: close() and open() again.
  Result<void> send(const Packet& packet) {
    Result<void> sent = do_send(packet);
    if (!sent.ok() && sent.code() != ErrorCode::kBusy) {
      ++counters_.refused;
      return sent;
    }
    ++counters_.packets;
    counters_.bytes += packet.size();
    if (!sent.ok()) ++counters_.dropped;
    return sent;
  }
  /// Moves on a packet that waits; to be called in each iteration. Gives how long it may wait further until there is
  /// anything to do again; Duration::max(): nothing waits.
  Result<Duration> serve() { return do_serve(); }
  /// Copies what has come from the robots' side to the begin of `into`; gives how many bytes, 0 when there are none.
  Result<std::size_t> receive(std::span<std::byte> into) {
    Result<std::size_t> received = do_receive(into);
    if (received.ok()) counters_.received_bytes += received.value();
    return received;
  }
  /// Waits until everything handed over has left, at most until `deadline`; for the stop packets at the end.
  Result<void> drain(Instant deadline) { return do_drain(deadline); }

  /// File descriptor to which a handler of fatal signals may write whole packets while the radio is open; -1: none.
  [[nodiscard]] virtual int descriptor() const { return -1; }
  [[nodiscard]] const RadioCounters& counters() const { return counters_; }
  /// Valid after open(): one line with the port and its settings; empty if there are none.
  [[nodiscard]] virtual const std::string& description() const { return no_description_; }

 private:
  virtual Result<void> do_open() = 0;
  virtual Result<void> do_send(const Packet& packet) = 0;
  virtual Result<Duration> do_serve() = 0;
  virtual Result<std::size_t> do_receive(std::span<std::byte> into) = 0;
  virtual Result<void> do_drain(Instant deadline) = 0;
  virtual void do_close() = 0;
  RadioCounters counters_;
  const std::string no_description_;
};

}  // namespace touchline::hal
