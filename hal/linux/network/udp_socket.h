#pragma once

#include <netinet/in.h>
#include <string>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_address.h"

// Functions for both UDP outputs and inputs.
namespace touchline::hal {

sockaddr_in socket_address(std::uint32_t ipv4, std::uint16_t port);
/// Returns an error that names the address, the step that failed and the cause. `error`: an errno.
Error network_error(const std::string& address, const char* doing, int error);
/// Returns a UDP socket that does not block.
Result<Descriptor> udp_socket(const std::string& address);
template <class T>
Result<void> set_option(const Descriptor& socket, int level, int option, const T& value, const std::string& address,
                        const char* doing) {
  if (::setsockopt(socket.get(), level, option, &value, sizeof(value)) == 0) return {};
  return network_error(address, doing, errno);
}
/// Returns the index of the interface that the address names; 0 if it names none. kNotFound: there is no such
/// interface.
Result<unsigned> interface_index(const NetworkAddress& address);
/// Makes a unicast socket send and receive through one interface only. (Multicast selects its interface by other
/// options.)
Result<void> bind_to_interface(const Descriptor& socket, const NetworkAddress& address);

}  // namespace touchline::hal
