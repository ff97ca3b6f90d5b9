#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/fixed_vector.h"
#include "core/types.h"
#include "hal/line_time.h"
#include "hal/result.h"

namespace touchline::hal {

struct RadioCounters {
  std::uint64_t packets = 0, bytes = 0;  // packets accepted by send()
  std::uint64_t dropped = 0;             // packets accepted, but replaced by a newer one
  std::uint64_t refused = 0;             // failed calls of send()
  std::uint64_t received_bytes = 0;
  std::uint64_t unreachable = 0;  // packets that the network did not pass on to their receiver
};

/// Where bytes leave this computer: a file descriptor, for a datagram its destination, for a serial port its line.
struct RadioRoute {
  int descriptor = -1;
  bool is_datagram = false;
  std::uint32_t ipv4 = 0;  // 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;
  LineTime line{};
};
/// Each of several radios may send a packet to each robot as a datagram of its own.
constexpr std::size_t kMaxRadios = 4;
using RadioRoutes = FixedVector<RadioRoute, kMaxRobotsPerTeam * kMaxRadios>;

/// The link to the robots. Only open() and drain() may block, and only open() may allocate.
class Radio {
 public:
  virtual ~Radio() = default;

  Result<void> open() { return do_open(); }
  void close() { do_close(); }

  /// Sends a packet of at least one byte to `receiver`: a robot, as its index in the team file's list own.robot, or
  /// kAllRobots. While the line is busy with an earlier packet, the new one waits. kBusy: the new packet was accepted
  /// and replaced an older waiting one, of this receiver unless it is for all robots. kDisconnected, kIo: close() and
  /// open() again.
  Result<void> send(const Packet& packet, std::size_t receiver = kAllRobots) {
    Result<void> sent = do_send(packet, receiver);
    if (!sent.ok() && sent.code() != ErrorCode::kBusy) {
      ++counters_.refused;
      return sent;
    }
    ++counters_.packets;
    counters_.bytes += packet.size();
    if (!sent.ok()) ++counters_.dropped;
    return sent;
  }
  /// Sends a waiting packet if the line is free; call it in each iteration of the loop. Returns the time after which
  /// the next call is useful; Duration::max(): no packet waits.
  Result<Duration> serve() { return do_serve(); }
  /// Copies bytes received from the robots to `into`; returns their number, 0 if there are none. `sender`: the robot
  /// that has sent all of them, as an index as in send(), or kAllRobots if the radio cannot tell.
  Result<std::size_t> receive(std::span<std::byte> into, std::size_t& sender) {
    sender = kAllRobots;
    Result<std::size_t> received = do_receive(into, sender);
    if (received.ok()) counters_.received_bytes += received.value();
    return received;
  }
  Result<std::size_t> receive(std::span<std::byte> into) {
    std::size_t sender = kAllRobots;
    return receive(into, sender);
  }
  /// Waits until all packets are sent, at most until `deadline` (kTimeout). Used for the stop packets at the exit.
  Result<void> drain(Instant deadline) { return do_drain(deadline); }

  /// Adds where a handler of fatal signals can write whole packets for `receiver` while the radio is open; nothing if
  /// it cannot.
  virtual void add_routes(std::size_t /*receiver*/, RadioRoutes& /*out*/) const {}
  /// A radio of several ports reopens lost ports itself, while the others go on. Returns since when a port is lost, on
  /// the loop's clock; nullopt: none is.
  [[nodiscard]] virtual std::optional<Instant> partly_lost_since() const { return std::nullopt; }
  /// Returns what happened to a port since the last call: an error, or kOk if it was reopened; nullopt: nothing more.
  virtual std::optional<Error> take_port_event() { return std::nullopt; }
  [[nodiscard]] const RadioCounters& counters() const { return counters_; }
  /// Returns one line with the port and its settings; empty if there are none. Valid after open().
  [[nodiscard]] virtual const std::string& description() const { return no_description_; }

 protected:
  void count_unreachable(std::uint64_t packets) { counters_.unreachable += packets; }

 private:
  virtual Result<void> do_open() = 0;
  virtual Result<void> do_send(const Packet& packet, std::size_t receiver) = 0;
  virtual Result<Duration> do_serve() = 0;
  virtual Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) = 0;
  virtual Result<void> do_drain(Instant deadline) = 0;
  virtual void do_close() = 0;
  RadioCounters counters_;
  const std::string no_description_;
};

}  // namespace touchline::hal
