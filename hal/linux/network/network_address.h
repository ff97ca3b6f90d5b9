#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/result.h"

namespace touchline::hal {

/// Source or destination of datagrams: an IPv4 address and port, or a unix socket.
struct NetworkAddress {
  enum class Kind : std::uint8_t { kUdp, kUnix };
  Kind kind = Kind::kUdp;
  std::uint32_t ipv4 = 0;  // 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;
  std::string interface;  // name, such as "eth0"; empty: the system's routes decide
  std::string path;       // path of the unix socket

  [[nodiscard]] bool is_multicast() const { return kind == Kind::kUdp && ipv4 >> 28 == 0xe; }
  /// Returns "udp://224.5.23.2:10006%eth0" or "unix:///run/touchline.sock".
  [[nodiscard]] std::string text() const;

  friend bool operator==(const NetworkAddress&, const NetworkAddress&) = default;
};

/// Reads "udp://ADDRESS:PORT", "udp://ADDRESS:PORT%INTERFACE" or "unix:///PATH". ADDRESS is an IPv4 address in numbers,
/// or localhost. kOutOfRange: the message names the part that is wrong.
Result<NetworkAddress> parse_network_address(std::string_view text);

/// Addresses of computers: a network of IPv4 addresses, or a single address.
struct NetworkRange {
  std::uint32_t ipv4 = 0;
  int prefix_bits = 32;

  [[nodiscard]] bool contains(std::uint32_t address) const {
    return prefix_bits == 0 || (address ^ ipv4) >> (32 - prefix_bits) == 0;
  }
};

/// Reads "192.168.1.20" or "192.168.1.0/24". Errors as parse_network_address().
Result<NetworkRange> parse_network_range(std::string_view text);

/// Returns text such as "192.168.1.20".
std::string ipv4_text(std::uint32_t address);

}  // namespace touchline::hal
