#include "hal/linux/network/udp_socket.h"

#include <linux/filter.h>
#include <net/if.h>
#include <sys/socket.h>
#include <cerrno>

#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// A classic BPF program (linux/filter.h) that accepts the packets of these senders and drops all others.
std::vector<sock_filter> filter_of(const std::vector<NetworkRange>& senders) {
  constexpr std::uint32_t kSourceAddress = 12;  // offset in the header of IPv4
  const auto load = [&] {
    return sock_filter{BPF_LD | BPF_W | BPF_ABS, 0, 0, static_cast<std::uint32_t>(SKF_NET_OFF) + kSourceAddress};
  };
  std::vector<sock_filter> program;
  for (const NetworkRange& range : senders) {
    const std::uint32_t mask = range.prefix_bits == 0 ? 0 : ~std::uint32_t{0} << (32 - range.prefix_bits);
    program.push_back(load());
    program.push_back({BPF_ALU | BPF_AND | BPF_K, 0, 0, mask});
    program.push_back({BPF_JMP | BPF_JEQ | BPF_K, 0, 1, range.ipv4 & mask});
    program.push_back({BPF_RET | BPF_K, 0, 0, ~std::uint32_t{0}});
  }
  program.push_back({BPF_RET | BPF_K, 0, 0, 0});
  return program;
}

}  // namespace

ErrorCode network_error_code(int error) {
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

sockaddr_in socket_address(std::uint32_t ipv4, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = htonl(ipv4);
  out.sin_port = htons(port);
  return out;
}

Error network_error(const std::string& address, const char* doing, int error) {
  Error out = failure(network_error_code(error), "%s: %s failed: %s", address.c_str(), doing, system_text(error));
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

Result<Descriptor> bound_udp_socket(const NetworkAddress& address) {
  const std::string name = address.text();
  TOUCHLINE_TRY_ASSIGN(Descriptor socket, udp_socket(name));
  const sockaddr_in at = socket_address(address.ipv4, address.port);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)) == 0) return socket;
  return network_error(name, "binding", errno);
}

void keep_senders(const Descriptor& socket, const std::vector<NetworkRange>& senders) {
  std::vector<sock_filter> filter = filter_of(senders);
  if (filter.size() > BPF_MAXINSNS) return;
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  static_cast<void>(::setsockopt(socket.get(), SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)));
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
