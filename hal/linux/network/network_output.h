#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "hal/linux/network/network_address.h"
#include "hal/result.h"

namespace touchline::hal {

/// A destination of messages. No call blocks; messages that cannot be sent at once are lost.
class NetworkOutput {
 public:
  virtual ~NetworkOutput() = default;
  /// Opens the socket. On error the message names the address, and open() may be called again.
  virtual Result<void> open() = 0;
  /// Sends one message. On error the output must be closed and opened again.
  virtual Result<void> send(std::span<const std::byte> message) = 0;
  virtual void close() = 0;
  /// Returns the number of messages lost because a receiver or the network was too slow.
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;
};

/// UDP: one datagram per message. Multicast leaves through the interface that the address names, is seen by programs on
/// this computer, and crosses no router (TTL 1). Unix: Touchline listens, and every program that connects to the stream
/// gets each message; a message is a line with its end.
std::unique_ptr<NetworkOutput> make_network_output(const NetworkAddress& address);

}  // namespace touchline::hal
