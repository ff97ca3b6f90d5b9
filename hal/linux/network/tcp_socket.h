#pragma once

#include <string>
#include <string_view>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_address.h"
#include "hal/result.h"

namespace touchline::hal {

/// Address of a TCP port: an IPv4 address in numbers, or localhost.
struct TcpAddress {
  std::uint32_t ipv4 = 0;  // 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;

  /// Returns "tcp://127.0.0.1:7640".
  [[nodiscard]] std::string text() const;
};

/// Reads "tcp://ADDRESS:PORT". kOutOfRange: the message names the part that is wrong.
Result<TcpAddress> parse_tcp_address(std::string_view text);

/// Returns a socket that listens and does not block. Errors name the address and the step that failed.
Result<Descriptor> listen_tcp(const TcpAddress& address);

/// Returns the port of a listening socket; 0 if it cannot be told.
std::uint16_t local_port(const Descriptor& socket);

/// Connects within `patience_ms` and returns a socket that does not block and sends small messages at once.
/// kNotFound: nobody listens there, or no network leads there.
Result<Descriptor> connect_tcp(const TcpAddress& address, int patience_ms);

}  // namespace touchline::hal
