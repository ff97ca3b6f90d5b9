#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/time.h"
#include "hal/linux/network/network_address.h"
#include "hal/result.h"

namespace touchline::hal {

/// A message that was received.
struct ReceivedMessage {
  std::size_t size = 0;
  bool is_complete = true;   // false: the message was longer than the buffer
  bool is_local = false;     // sent by this computer
  std::uint32_t sender = 0;  // IPv4 address; 0: unix socket
  std::uint16_t port = 0;    // port of the sender; unix socket: number of the connection
  Duration waited{};         // UDP: time since its arrival at this computer
};

/// A source of messages. No call blocks.
class NetworkInput {
 public:
  virtual ~NetworkInput() = default;
  /// Opens the socket. On error the message names the address, and open() may be called again.
  virtual Result<void> open() = 0;
  /// Returns a descriptor for poll(), which is readable if there may be a message. -1: the input is closed.
  [[nodiscard]] virtual int descriptor() const = 0;
  /// Receives one message; nullopt: there is none. On error the input must be closed and opened again.
  virtual Result<std::optional<ReceivedMessage>> receive(std::span<std::byte> into) = 0;
  /// Checks that the network is still as it was when the input was opened; call it about once a second. On error the
  /// input must be closed and opened again. An interface that was removed and added again has lost its multicast groups
  /// without an error.
  virtual Result<void> check() = 0;
  virtual void close() = 0;

  /// While `senders` is set, the system drops the messages of all other computers before they fill the socket's buffer.
  /// Returns the number of messages dropped since the last call, for this reason or because the buffer was full. Inputs
  /// without this ability receive all messages and return 0. close() ends the filter.
  virtual std::uint64_t drop_others(const std::optional<std::vector<NetworkRange>>& /*senders*/) { return 0; }
};

/// UDP: one message per datagram; multicast is received from the interface that the address names. Unix: Touchline
/// listens, and programs that connect to the stream send one message per line.
std::unique_ptr<NetworkInput> make_network_input(const NetworkAddress& address);

}  // namespace touchline::hal
