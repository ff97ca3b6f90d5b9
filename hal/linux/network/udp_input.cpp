#include "hal/linux/network/udp_input.h"

#include <ifaddrs.h>
#include <sys/socket.h>
#include <algorithm>
#include <cerrno>

namespace touchline::hal {
namespace {

std::vector<std::uint32_t> addresses_of_this_computer() {
  std::vector<std::uint32_t> out;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return out;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    out.push_back(ntohl(reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr.s_addr));
  }
  ::freeifaddrs(list);
  return out;
}

}  // namespace

Result<void> UdpInput::open() {
  close();
  TOUCHLINE_TRY_ASSIGN(Descriptor socket, udp_socket(name_));
  TOUCHLINE_TRY_ASSIGN(interface_, interface_index(address_));
  if (address_.is_multicast()) {
    // Several programs may listen to a group. Two that receive the same unicast would steal from each other.
    TOUCHLINE_TRY(set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1, name_, "sharing the port"));
  } else {
    TOUCHLINE_TRY(bind_to_interface(socket, address_));
  }
  const sockaddr_in at = socket_address(address_.ipv4, address_.port);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)) != 0) {
    return network_error(name_, "binding to the address", errno);
  }
  if (address_.is_multicast()) TOUCHLINE_TRY(join(socket));
  own_addresses_ = addresses_of_this_computer();
  socket_ = std::move(socket);
  return {};
}

Result<void> UdpInput::join(const Descriptor& socket) {
  // Otherwise the socket also receives what other programs of this computer have joined on other interfaces.
  TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_MULTICAST_ALL, 0, name_, "limiting multicast to its interface"));
  ip_mreqn group{};
  group.imr_multiaddr.s_addr = htonl(address_.ipv4);
  group.imr_ifindex = static_cast<int>(interface_);
  if (::setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group)) == 0) return {};
  // ENODEV: no interface is named, and no route leads to the group.
  return network_error(name_, "joining the multicast group", errno == ENODEV ? ENETUNREACH : errno);
}

bool UdpInput::is_local(std::uint32_t sender) const {
  constexpr std::uint32_t kLoopbackNetwork = 127;
  return sender >> 24 == kLoopbackNetwork ||
         std::find(own_addresses_.begin(), own_addresses_.end(), sender) != own_addresses_.end();
}

Result<std::optional<ReceivedMessage>> UdpInput::receive(std::span<std::byte> into) {
  sockaddr_in from{};
  iovec part{into.data(), into.size()};
  msghdr header{};
  header.msg_name = &from;
  header.msg_namelen = sizeof(from);
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  ssize_t size = 0;
  do {
    size = ::recvmsg(socket_.get(), &header, 0);
  } while (size < 0 && errno == EINTR);
  if (size < 0) {
    if (errno == EAGAIN || errno == ECONNREFUSED) return std::optional<ReceivedMessage>();
    return network_error(name_, "receiving", errno);
  }
  ReceivedMessage message;
  message.size = static_cast<std::size_t>(size);
  message.is_complete = (header.msg_flags & MSG_TRUNC) == 0;
  message.sender = ntohl(from.sin_addr.s_addr);
  message.port = ntohs(from.sin_port);
  message.is_local = is_local(message.sender);
  return std::optional(message);
}

Result<void> UdpInput::check() {
  TOUCHLINE_TRY_ASSIGN(const unsigned index, interface_index(address_));
  if (index != interface_) {
    return failure(ErrorCode::kDisconnected, "%s: the interface was removed and added again", name_.c_str());
  }
  own_addresses_ = addresses_of_this_computer();
  return {};
}

}  // namespace touchline::hal
