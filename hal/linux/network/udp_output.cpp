#include "hal/linux/network/udp_output.h"

#include <sys/socket.h>
#include <cerrno>

namespace touchline::hal {

Result<void> UdpOutput::open() {
  close();
  TOUCHLINE_TRY_ASSIGN(Descriptor socket, udp_socket(name_));
  if (address_.is_multicast()) {
    TOUCHLINE_TRY_ASSIGN(const unsigned index, interface_index(address_));
    if (index != 0) {
      ip_mreqn interface {};
      interface.imr_ifindex = static_cast<int>(index);
      TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_MULTICAST_IF, interface, name_, "choosing the interface"));
    }
    // Routers must not forward the packets, because a league's network is one segment.
    TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_MULTICAST_TTL, 1, name_, "setting the time to live"));
    TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_MULTICAST_LOOP, 1, name_, "allowing receivers on this computer"));
  } else {
    TOUCHLINE_TRY(set_option(socket, SOL_SOCKET, SO_BROADCAST, 1, name_, "allowing broadcast"));
    TOUCHLINE_TRY(bind_to_interface(socket, address_));
  }
  socket_ = std::move(socket);
  return {};
}

Result<void> UdpOutput::send(std::span<const std::byte> message) {
  const sockaddr_in to = socket_address(address_.ipv4, address_.port);
  const auto* destination = reinterpret_cast<const sockaddr*>(&to);
  while (::sendto(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL, destination, sizeof(to)) < 0) {
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != ENOBUFS && errno != ECONNREFUSED) return network_error(name_, "sending", errno);
    ++dropped_;  // the interface's queue is full, or nobody listens
    break;
  }
  return {};
}

}  // namespace touchline::hal
