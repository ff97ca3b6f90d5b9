#include "hal/linux/network/udp_radio.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <utility>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Pause before a datagram that was not taken is offered again. The queue of an interface empties in well below that.
constexpr Duration kRetryPause = std::chrono::milliseconds(2);
constexpr Duration kDrainPause = std::chrono::milliseconds(1);
// An interface without a link takes datagrams and drops them, so its state is asked for. Robots stop by themselves
// after 200 ms (docs/radio.md); by then the loop knows that the link is lost.
constexpr Duration kLinkPeriod = std::chrono::milliseconds(50);
// The system counts about 768 bytes for a datagram and doubles this size, so a queue has room for four. More would be
// old commands.
constexpr int kSendBufferBytes = 1536;
// Datagrams that a socket receives in one call at most, so that a flood from a robot's address does not hold up the
// loop.
constexpr int kMaxDatagrams = 8;

/// Name of the interface with this address; "" if there is none.
std::string interface_with(std::uint32_t ipv4) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    if (ntohl(reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr.s_addr) == ipv4) return entry->ifa_name;
  }
  return {};
}

/// True if the interface exists, is up, and has a cable or a Wi-Fi connection.
bool has_link(const Descriptor& socket, const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  return ::ioctl(socket.get(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_RUNNING) != 0;
}

std::string text_of(const UdpEndpoint& endpoint) {
  return ipv4_text(endpoint.ipv4) + ":" + std::to_string(endpoint.port);
}

}  // namespace

UdpRadio::UdpRadio(const UdpRadioSettings& settings) : settings_(settings) {
  for (std::size_t i = 0; i < kCommon; ++i) endpoints_[i].to = settings.robots[i];
  endpoints_[kCommon].to = settings.common;
  std::size_t count = 0;
  for (const Endpoint& endpoint : endpoints_) {
    if (endpoint.to.exists() && count++ == 0) name_ = "udp://" + text_of(endpoint.to);
  }
  if (count > 1) name_ += " and " + std::to_string(count - 1) + " more";
  if (!settings.interface.empty()) name_ += ", interface " + settings.interface;
}

Result<void> UdpRadio::do_open() {
  do_close();
  Result<void> opened = open_sockets();
  if (!opened.ok()) do_close();
  return opened;
}

Result<void> UdpRadio::open_sockets() {
  interfaces_.clear();
  for (Endpoint& endpoint : endpoints_) {
    if (!endpoint.to.exists()) continue;
    TOUCHLINE_TRY_ASSIGN(endpoint.socket, open_socket(0));
    TOUCHLINE_TRY(find_interface(endpoint.to));
  }
  if (settings_.local_port != 0) {
    TOUCHLINE_TRY_ASSIGN(telemetry_, open_socket(settings_.local_port));
  }
  is_open_ = true;
  description_ = name_;
  if (settings_.local_port != 0) description_ += ", telemetry at port " + std::to_string(settings_.local_port);
  return {};
}

Result<Descriptor> UdpRadio::open_socket(std::uint16_t local_port) const {
  TOUCHLINE_TRY_ASSIGN(Descriptor socket, udp_socket(name_));
  NetworkAddress on_interface;
  on_interface.interface = settings_.interface;
  TOUCHLINE_TRY_ASSIGN(const unsigned index, interface_index(on_interface));
  if (index != 0) {
    TOUCHLINE_TRY(bind_to_interface(socket, on_interface));
    ip_mreqn interface {};
    interface.imr_ifindex = static_cast<int>(index);
    TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_MULTICAST_IF, interface, name_, "choosing the interface"));
  }
  TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_TTL, settings_.time_to_live, name_, "setting the time to live"));
  TOUCHLINE_TRY(
      set_option(socket, IPPROTO_IP, IP_MULTICAST_TTL, settings_.time_to_live, name_, "setting the time to live"));
  TOUCHLINE_TRY(set_option(socket, SOL_SOCKET, SO_BROADCAST, 1, name_, "allowing broadcast"));
  TOUCHLINE_TRY(set_option(socket, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes, name_, "limiting the queue"));
  // The network's messages about a receiver arrive in a queue of their own.
  TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_RECVERR, 1, name_, "asking for the network's messages"));
  std::vector<NetworkRange> senders;
  for (const Endpoint& endpoint : endpoints_) {
    if (endpoint.to.exists()) senders.push_back({endpoint.to.ipv4, 32});
  }
  keep_senders(socket, senders);
  const sockaddr_in at = socket_address(INADDR_ANY, local_port);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)) != 0) {
    return network_error(name_ + ", local port " + std::to_string(local_port), "binding", errno);
  }
  return socket;
}

/// Finds the interface that leads to the endpoint. kNotFound: there is none, or it has no link.
Result<void> UdpRadio::find_interface(const UdpEndpoint& endpoint) {
  // connect() of a UDP socket looks up the route and sends nothing.
  TOUCHLINE_TRY_ASSIGN(const Descriptor probe, open_socket(0));
  const sockaddr_in to = socket_address(endpoint.ipv4, endpoint.port);
  sockaddr_in from{};
  socklen_t size = sizeof(from);
  if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&to), sizeof(to)) != 0) {
    return failure(ErrorCode::kNotFound, "%s: no network leads to %s: %s; connect the network, `ip route` lists them",
                   name_.c_str(), text_of(endpoint).c_str(), system_text(errno));
  }
  std::string interface = settings_.interface;
  if (interface.empty() && ::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&from), &size) == 0) {
    interface = interface_with(ntohl(from.sin_addr.s_addr));
  }
  if (interface.empty() || std::find(interfaces_.begin(), interfaces_.end(), interface) != interfaces_.end()) return {};
  if (!has_link(probe, interface)) {
    return failure(ErrorCode::kNotFound, "%s: the interface %s has no link; connect the cable or Wi-Fi", name_.c_str(),
                   interface.c_str());
  }
  interfaces_.push_back(std::move(interface));
  return {};
}

Result<void> UdpRadio::check_link() {
  const Instant now = MonotonicClock::read();
  if (now - link_checked_ < kLinkPeriod) return {};
  link_checked_ = now;
  const auto open = std::find_if(endpoints_.begin(), endpoints_.end(),
                                 [](const Endpoint& endpoint) { return endpoint.socket.is_open(); });
  for (const std::string& interface : interfaces_) {
    if (has_link(open->socket, interface)) continue;
    lost_ =
        failure(ErrorCode::kDisconnected, "%s: the interface %s has lost its link", name_.c_str(), interface.c_str());
    return *lost_;
  }
  return {};
}

Result<void> UdpRadio::check_usable() const {
  if (lost_) return *lost_;
  if (is_open_) return {};
  return failure(ErrorCode::kDisconnected, "%s: not open", name_.c_str());
}

void UdpRadio::add_routes(std::size_t receiver, RadioRoutes& out) const {
  if (!is_open_) return;
  for_each_endpoint(receiver, [&](std::size_t index) {
    const Endpoint& endpoint = endpoints_[index];
    out.push_back({endpoint.socket.get(), true, endpoint.to.ipv4, endpoint.to.port, {}});
  });
}

Result<void> UdpRadio::do_send(const Packet& packet, std::size_t receiver) {
  TOUCHLINE_TRY(check_usable());
  TOUCHLINE_TRY(check_link());
  Result<void> result;
  for_each_endpoint(receiver, [&](std::size_t index) {
    Endpoint& endpoint = endpoints_[index];
    static_cast<void>(drain_errors(endpoint.socket));
    if (!endpoint.waiting.empty()) count_unreachable(1);
    endpoint.waiting = packet;
    if (result.ok()) result = flush(endpoint);
  });
  return result;
}

Result<void> UdpRadio::flush(Endpoint& endpoint) {
  const sockaddr_in to = socket_address(endpoint.to.ipv4, endpoint.to.port);
  const auto* const destination = reinterpret_cast<const sockaddr*>(&to);
  // A call fails without effect if a message about an earlier datagram has arrived meanwhile.
  for (std::size_t attempt = 0; attempt <= kMaxReceivers; ++attempt) {
    if (::sendto(endpoint.socket.get(), endpoint.waiting.data(), endpoint.waiting.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                 destination, sizeof(to)) >= 0) {
      endpoint.waiting.clear();
      return {};
    }
    const int error = errno;
    if (error == EAGAIN || error == ENOBUFS) return {};
    if (error != EINTR && !drain_errors(endpoint.socket)) return fail("sending", error);
  }
  return {};
}

/// Reads and counts the network's messages about datagrams. False: there is none.
bool UdpRadio::drain_errors(const Descriptor& socket) {
  bool found = false;
  for (std::size_t i = 0; i <= kMaxReceivers; ++i) {
    std::array<std::byte, 256> control{};
    msghdr header{};
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    if (::recvmsg(socket.get(), &header, MSG_ERRQUEUE | MSG_DONTWAIT) < 0) break;
    found = true;
    count_unreachable(1);
  }
  return found;
}

bool UdpRadio::is_waiting() const {
  return std::any_of(endpoints_.begin(), endpoints_.end(),
                     [](const Endpoint& endpoint) { return !endpoint.waiting.empty(); });
}

Result<Duration> UdpRadio::do_serve() {
  if (!is_waiting()) return Duration::max();
  TOUCHLINE_TRY(check_usable());
  for (Endpoint& endpoint : endpoints_) {
    if (!endpoint.waiting.empty()) TOUCHLINE_TRY(flush(endpoint));
  }
  return is_waiting() ? kRetryPause : Duration::max();
}

bool UdpRadio::is_from_robot(std::uint32_t sender) const {
  return std::any_of(endpoints_.begin(), endpoints_.end(),
                     [&](const Endpoint& endpoint) { return endpoint.to.exists() && endpoint.to.ipv4 == sender; });
}

std::size_t UdpRadio::robot_at(const UdpEndpoint& from, std::size_t endpoint) const {
  std::size_t found = kAllRobots, count = 0;
  for (std::size_t robot = 0; robot < kCommon; ++robot) {
    const UdpEndpoint& to = endpoints_[robot].to;
    if (!to.exists() || to.ipv4 != from.ipv4) continue;
    if (to.port == from.port) return robot;
    found = robot;
    ++count;
  }
  // A robot may answer from another port than the one at which it listens.
  if (endpoint < kCommon && endpoints_[endpoint].to.ipv4 == from.ipv4) return endpoint;
  return count == 1 ? found : kAllRobots;
}

Result<std::size_t> UdpRadio::do_receive(std::span<std::byte> into, std::size_t& sender) {
  TOUCHLINE_TRY(check_usable());
  // The sockets take turns, because the bytes of one call come from one robot.
  for (std::size_t n = 0; n < endpoints_.size(); ++n) {
    const std::size_t i = std::exchange(next_endpoint_, (next_endpoint_ + 1) % endpoints_.size());
    if (!endpoints_[i].to.exists()) continue;
    TOUCHLINE_TRY_ASSIGN(const std::size_t count, receive_from(endpoints_[i].socket, i, into, sender));
    if (count > 0) return count;
  }
  if (!telemetry_.is_open()) return std::size_t{0};
  return receive_from(telemetry_, kCommon, into, sender);
}

/// Receives datagrams of one robot.
Result<std::size_t> UdpRadio::receive_from(const Descriptor& socket, std::size_t endpoint, std::span<std::byte> into,
                                           std::size_t& sender) {
  std::size_t received = 0;
  // A datagram that might not fit, or that is another robot's, is left for the next call.
  for (int i = 0; i < kMaxDatagrams && into.size() - received >= kMaxPacketBytes; ++i) {
    sockaddr_in from{};
    iovec part{into.data() + received, into.size() - received};
    msghdr header{};
    header.msg_name = &from;
    header.msg_namelen = sizeof(from);
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    const auto robot = [&] { return robot_at({ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)}, endpoint); };
    if (received > 0) {
      if (::recvmsg(socket.get(), &header, MSG_DONTWAIT | MSG_PEEK) < 0 || robot() != sender) break;
      header.msg_namelen = sizeof(from);
    }
    const ssize_t size = ::recvmsg(socket.get(), &header, MSG_DONTWAIT);
    if (size < 0) {
      if (errno == EAGAIN) break;
      const int error = errno;
      if (error == EINTR || drain_errors(socket)) continue;
      return fail("receiving", error);
    }
    const bool is_complete = (header.msg_flags & MSG_TRUNC) == 0;
    if (!is_complete || !is_from_robot(ntohl(from.sin_addr.s_addr))) continue;
    received += static_cast<std::size_t>(size);
    sender = robot();
  }
  return received;
}

Result<void> UdpRadio::do_drain(Instant deadline) {
  // What waits for a robot that is switched off must not delay the end: no link needs longer for the others.
  constexpr Duration kPatience = std::chrono::milliseconds(50);
  const Instant end = std::min(deadline, MonotonicClock::read() + kPatience);
  for (;;) {
    TOUCHLINE_TRY(check_usable());
    TOUCHLINE_TRY(do_serve());
    const Instant now = MonotonicClock::read();
    if (!is_waiting() || now >= end) return {};
    MonotonicClock::wait_for(std::min(end, now + kDrainPause));
  }
}

void UdpRadio::do_close() {
  for (Endpoint& endpoint : endpoints_) {
    endpoint.socket.reset();
    endpoint.waiting.clear();
  }
  telemetry_.reset();
  is_open_ = false;
  lost_.reset();
}

Error UdpRadio::fail(const char* doing, int error) noexcept {
  lost_ = failure(network_error_code(error), "%s: %s failed: %s", name_.c_str(), doing, system_text(error));
  return *lost_;
}

}  // namespace touchline::hal
