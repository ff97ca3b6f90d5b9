#include "hal/linux/network/udp_socket.h"

#include <net/if.h>
#include <sys/socket.h>
#include <cerrno>

#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

ErrorCode code_of(int error) {
  switch (error) {
    case EADDRINUSE:
      return ErrorCode::kDeviceBusy;
    case ENETUNREACH:
    case ENETDOWN:
    case EHOSTUNREACH:
    case EADDRNOTAVAIL:
      return ErrorCode::kDisconnected;
    default:
      return open_error(error);
  }
}

}  // namespace

sockaddr_in socket_address(std::uint32_t ipv4, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = htonl(ipv4);
  out.sin_port = htons(port);
  return out;
}

Error network_error(const std::string& address, const char* doing, int error) {
  Error out = failure(code_of(error), "%s: %s failed: %s", address.c_str(), doing, system_text(error));
  if (error == ENETUNREACH) {
    out.text.append(
        "; connect the network, or name the interface: udp://ADDRESS:PORT%INTERFACE (`ip link` lists them)");
  } else if (error == EADDRINUSE) {
    out.text.append("; `ss -ulpn` lists the programs that receive UDP");
  }
  return out;
}

Result<Descriptor> udp_socket(const std::string& address) {
  Descriptor out(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!out.is_open()) return network_error(address, "opening the socket", errno);
  return out;
}

Result<unsigned> interface_index(const NetworkAddress& address) {
  if (address.interface.empty()) return 0U;
  const unsigned index = ::if_nametoindex(address.interface.c_str());
  if (index != 0) return index;
  return failure(ErrorCode::kNotFound, "%s: there is no interface %s; `ip link` lists them", address.text().c_str(),
                 address.interface.c_str());
}

Result<void> bind_to_interface(const Descriptor& socket, const NetworkAddress& address) {
  if (address.interface.empty()) return {};
  TOUCHLINE_TRY(interface_index(address));
  const std::string& name = address.interface;
  if (::setsockopt(socket.get(), SOL_SOCKET, SO_BINDTODEVICE, name.c_str(), static_cast<socklen_t>(name.size())) == 0) {
    return {};
  }
  return network_error(address.text(), "binding to the interface", errno);
}

}  // namespace touchline::hal
