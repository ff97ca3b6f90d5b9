#pragma once

#include <netinet/in.h>
#include <string>
#include <vector>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_address.h"

// Functions for both UDP outputs and inputs.
namespace touchline::hal {

sockaddr_in socket_address(std::uint32_t ipv4, std::uint16_t port);
/// Code for an errno of a socket: kDisconnected if the network cannot be reached.
ErrorCode network_error_code(int error);
/// Error that names the address, the step that failed and the cause. `error`: an errno.
Error network_error(const std::string& address, const char* doing, int error);
/// Returns a UDP socket that does not block.
Result<Descriptor> udp_socket(const std::string& address);
/// Returns a UDP socket that does not block and receives at this address of the computer.
Result<Descriptor> bound_udp_socket(const NetworkAddress& address);
template <class T>
Result<void> set_option(const Descriptor& socket, int level, int option, const T& value, const std::string& address,
                        const char* doing) {
  if (::setsockopt(socket.get(), level, option, &value, sizeof(value)) == 0) return {};
  return network_error(address, doing, errno);
}
/// Lets the system drop the datagrams of all other senders before they take room in the socket's buffer. The system
/// refuses very long lists; then all datagrams are received.
void keep_senders(const Descriptor& socket, const std::vector<NetworkRange>& senders);
/// Index of the interface that the address names; 0: it names none. kNotFound: there is no such interface.
Result<unsigned> interface_index(const NetworkAddress& address);
/// Makes a unicast socket send and receive through one interface only. (Multicast selects its interface by other
/// options.)
Result<void> bind_to_interface(const Descriptor& socket, const NetworkAddress& address);

}  // namespace touchline::hal
