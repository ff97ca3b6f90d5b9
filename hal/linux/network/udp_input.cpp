#include "hal/linux/network/udp_input.h"

#include <ifaddrs.h>
#include <linux/sock_diag.h>
#include <sys/socket.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

namespace touchline::hal {
namespace {

constexpr NetworkRange kLoopback{0x7f000000, 8};

// Buffer for the messages that a sender at the usual limit (1000 a second) sends while the receiver's thread waits a
// second for a processor. The system counts about 1 KB for each message.
constexpr int kReceiveBufferBytes = 1 << 20;

void enlarge_buffer(const Descriptor& socket) {
  // A size beyond net.core.rmem_max needs CAP_NET_ADMIN. Without it, the granted size is enough for a network without a
  // flood.
  const auto set = [&](int option) {
    return ::setsockopt(socket.get(), SOL_SOCKET, option, &kReceiveBufferBytes, sizeof(kReceiveBufferBytes)) == 0;
  };
  if (!set(SO_RCVBUFFORCE)) static_cast<void>(set(SO_RCVBUF));
}

// A message that waited longer, according to its stamp, arrived before the system's clock was set.
constexpr Duration kLongestWait = std::chrono::seconds(10);

/// Returns the time since the system received the message.
Duration time_waited(const msghdr& header) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
       part = CMSG_NXTHDR(const_cast<msghdr*>(&header), part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec arrival{}, now{};
    std::memcpy(&arrival, CMSG_DATA(part), sizeof(arrival));
    ::clock_gettime(CLOCK_REALTIME, &now);
    const Duration waited =
        std::chrono::seconds(now.tv_sec - arrival.tv_sec) + std::chrono::nanoseconds(now.tv_nsec - arrival.tv_nsec);
    return waited >= Duration{} && waited <= kLongestWait ? waited : Duration{};
  }
  return {};
}

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
  enlarge_buffer(socket);
  TOUCHLINE_TRY(set_option(socket, SOL_SOCKET, SO_TIMESTAMPNS, 1, name_, "stamping messages with their arrival"));
  if (address_.is_multicast()) {
    // Several programs may listen to a multicast group. With unicast, two programs at one port would take messages from
    // each other.
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
  dropped_ = 0;
  return {};
}

Result<void> UdpInput::join(const Descriptor& socket) {
  // Without this option, the socket also receives groups that other programs of this computer have joined on other
  // interfaces.
  TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_MULTICAST_ALL, 0, name_, "limiting multicast to its interface"));
  ip_mreqn group{};
  group.imr_multiaddr.s_addr = htonl(address_.ipv4);
  group.imr_ifindex = static_cast<int>(interface_);
  if (::setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group)) == 0) return {};
  // ENODEV: no interface is named, and no route leads to the group.
  return network_error(name_, "joining the multicast group", errno == ENODEV ? ENETUNREACH : errno);
}

bool UdpInput::is_local(std::uint32_t sender) const {
  return kLoopback.contains(sender) ||
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
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
  header.msg_control = control.data();
  header.msg_controllen = control.size();
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
  message.waited = time_waited(header);
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

std::uint64_t UdpInput::drop_others(const std::optional<std::vector<NetworkRange>>& senders) {
  if (senders) {
    std::vector<NetworkRange> accepted = *senders;
    accepted.push_back(kLoopback);
    for (const std::uint32_t own : own_addresses_) accepted.push_back({own, 32});
    return drop_others_but(accepted);
  }
  constexpr int kNone = 0;
  static_cast<void>(::setsockopt(socket_.get(), SOL_SOCKET, SO_DETACH_FILTER, &kNone, sizeof(kNone)));
  return new_drops();
}

std::uint64_t UdpInput::drop_others_but(const std::vector<NetworkRange>& senders) {
  keep_senders(socket_, senders);
  return new_drops();
}

std::uint64_t UdpInput::new_drops() {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof(memory);
  if (::getsockopt(socket_.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return 0;
  const std::uint32_t drops = memory[SK_MEMINFO_DROPS];
  return drops - std::exchange(dropped_, drops);
}

}  // namespace touchline::hal
