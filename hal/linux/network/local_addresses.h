#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

struct LocalAddress {
  std::string interface;  // "wlan0"
  std::string address;    // IPv4 address in numbers
};

/// Returns the addresses under which other computers reach this one: those of all interfaces that are up, without
/// loopback.
std::vector<LocalAddress> local_addresses();

}  // namespace touchline::hal
