#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/status.h"
#include "core/types.h"

namespace touchline::hal {

struct RadioCounters {
  std::uint64_t packets = 0, bytes = 0, refused = 0;  // refused: kBusy or an error
};

/// The link to the robots.
class Radio {
 public:
  virtual ~Radio() = default;

  /// May block. On error reason() tells a person what to do about it.
  Status open() { return do_open(); }
  void close() { do_close(); }

  /// Hands a packet to the driver; never blocks, never allocates. kBusy: nothing was queued, try at the next frame.
  /// kDisconnected, kIo: close() and open() again.
  Status send(const Packet& packet) {
    const Status status = do_send({packet.data(), packet.size()});
    if (status.ok()) {
      ++counters_.packets;
      counters_.bytes += packet.size();
    } else {
      ++counters_.refused;
    }
    return status;
  }
  /// Waits until everything handed over has left, at most until `deadline`; for the stop packets at the end.
  Status drain(Instant deadline) { return do_drain(deadline); }

  [[nodiscard]] const RadioCounters& counters() const { return counters_; }
  [[nodiscard]] virtual const std::string& reason() const = 0;

 private:
  virtual Status do_open() = 0;
  virtual Status do_send(std::span<const std::byte> bytes) = 0;
  virtual Status do_drain(Instant deadline) = 0;
  virtual void do_close() = 0;
  RadioCounters counters_;
};

}  // namespace touchline::hal
