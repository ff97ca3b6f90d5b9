#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "hal/result.h"

namespace touchline::arena {

/// Where the bytes for the arena's robots arrive, and where their telemetry goes. No call but open() blocks.
class RobotPort {
 public:
  virtual ~RobotPort() = default;

  /// Errors name the address or the device, the cause and what to do.
  virtual Result<void> open() = 0;
  /// Becomes readable when bytes arrive; valid after open().
  [[nodiscard]] virtual int descriptor() const = 0;
  /// Copies bytes that arrived to `into`, which has room for kMaxPacketBytes; returns their number, 0 if there are
  /// none.
  virtual Result<std::size_t> receive(std::span<std::byte> into) = 0;
  /// Returns whether received bytes are whole packets, else they are a stream.
  [[nodiscard]] virtual bool keeps_packets() const = 0;
  /// Returns whether send() would send now.
  virtual bool can_send() = 0;
  /// Sends telemetry of at most kMaxPacketBytes; it is lost if the other side is gone.
  virtual void send(std::span<const std::byte> bytes) = 0;
  /// Returns "udp://127.0.0.1:20016" or "/dev/ttyUSB0 at 115200 Bd".
  [[nodiscard]] virtual std::string text() const = 0;
};

/// Returns the port for "udp://ADDRESS:PORT" or a serial device. Telemetry goes to the sender of the last datagram.
/// `baud`: of a serial device; a pseudo terminal has none. kOutOfRange: the address cannot be used.
Result<std::unique_ptr<RobotPort>> make_robot_port(const std::string& where, int baud);

}  // namespace touchline::arena
