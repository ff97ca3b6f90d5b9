#include "hal/linux/network/network_input.h"
#include "hal/linux/network/network_output.h"
#include "hal/linux/network/udp_input.h"
#include "hal/linux/network/udp_output.h"
#include "hal/linux/network/unix_input.h"
#include "hal/linux/network/unix_output.h"

namespace touchline::hal {

std::unique_ptr<NetworkOutput> make_network_output(const NetworkAddress& address) {
  if (address.kind == NetworkAddress::Kind::kUnix) return std::make_unique<UnixOutput>(address);
  return std::make_unique<UdpOutput>(address);
}

std::unique_ptr<NetworkInput> make_network_input(const NetworkAddress& address) {
  if (address.kind == NetworkAddress::Kind::kUnix) return std::make_unique<UnixInput>(address);
  return std::make_unique<UdpInput>(address);
}

}  // namespace touchline::hal
