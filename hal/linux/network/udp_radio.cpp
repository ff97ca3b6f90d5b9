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

// A network that takes no datagram for this long is lost: robots have stopped by themselves meanwhile (docs/radio.md).
constexpr Duration kOutage = std::chrono::milliseconds(500);
// Pause before a datagram that was not taken is offered again. The queue of an interface empties in well below that.
constexpr Duration kRetryPause = std::chrono::milliseconds(2);
constexpr Duration kDrainPause = std::chrono::milliseconds(1);
// The system counts about 768 bytes for a datagram and doubles this size. So the socket's queue has room for one packet
// of each receiver, and a slow network does not get many old ones.
constexpr int kSendBufferBytes = 512 * kMaxReceivers;
// Datagrams that one call receives at most, so that a flood from a robot's address does not hold up the loop. At 100
// frames per second that are more than 11 robots send.
constexpr int kMaxDatagrams = 32;

/// True if the interface with this address has a link. An interface that is not found says nothing.
bool has_link(std::uint32_t ipv4) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return true;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    if (ntohl(reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr.s_addr) != ipv4) continue;
    return (entry->ifa_flags & IFF_RUNNING) != 0;
  }
  return true;
}

std::string text_of(const UdpEndpoint& endpoint) {
  return ipv4_text(endpoint.ipv4) + ":" + std::to_string(endpoint.port);
}

}  // namespace

UdpRadio::UdpRadio(const UdpRadioSettings& settings) : settings_(settings) {
  std::copy(settings.robots.begin(), settings.robots.end(), endpoints_.begin());
  endpoints_[kCommon] = settings.common;
  std::size_t count = 0;
  for (const UdpEndpoint& endpoint : endpoints_) {
    if (endpoint.exists() && count++ == 0) name_ = "udp://" + text_of(endpoint);
  }
  if (count > 1) name_ += " and " + std::to_string(count - 1) + " more";
  if (!settings.interface.empty()) name_ += ", interface " + settings.interface;
}

Result<void> UdpRadio::do_open() {
  do_close();
  TOUCHLINE_TRY_ASSIGN(Descriptor socket, udp_socket(name_));
  TOUCHLINE_TRY(configure(socket));
  for (const UdpEndpoint& endpoint : endpoints_) {
    if (endpoint.exists()) TOUCHLINE_TRY(check_route(endpoint));
  }
  description_ = name_;
  if (settings_.local_port != 0) description_ += ", telemetry at port " + std::to_string(settings_.local_port);
  socket_ = std::move(socket);
  return {};
}

Result<void> UdpRadio::configure(const Descriptor& socket) {
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
  // The network's messages about a receiver arrive in a queue of their own, with its address. The system also reports
  // datagrams that the interface did not take.
  TOUCHLINE_TRY(set_option(socket, IPPROTO_IP, IP_RECVERR, 1, name_, "asking for the network's messages"));
  std::vector<NetworkRange> senders;
  for (const UdpEndpoint& endpoint : endpoints_) {
    if (endpoint.exists()) senders.push_back({endpoint.ipv4, 32});
  }
  keep_senders(socket, senders);
  const sockaddr_in at = socket_address(INADDR_ANY, settings_.local_port);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)) != 0) {
    return network_error(name_ + ", local port " + std::to_string(settings_.local_port), "binding", errno);
  }
  return {};
}

Result<void> UdpRadio::check_route(const UdpEndpoint& endpoint) const {
  // connect() of another UDP socket looks up the route and sends nothing.
  TOUCHLINE_TRY_ASSIGN(const Descriptor probe, udp_socket(name_));
  NetworkAddress on_interface;
  on_interface.interface = settings_.interface;
  TOUCHLINE_TRY(bind_to_interface(probe, on_interface));
  TOUCHLINE_TRY(set_option(probe, SOL_SOCKET, SO_BROADCAST, 1, name_, "allowing broadcast"));
  const sockaddr_in to = socket_address(endpoint.ipv4, endpoint.port);
  sockaddr_in from{};
  socklen_t size = sizeof(from);
  if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&to), sizeof(to)) != 0) {
    return failure(ErrorCode::kNotFound, "%s: no network leads to %s: %s; connect the network, `ip route` lists them",
                   name_.c_str(), text_of(endpoint).c_str(), system_text(errno));
  }
  if (::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&from), &size) == 0 &&
      !has_link(ntohl(from.sin_addr.s_addr))) {
    return failure(ErrorCode::kNotFound, "%s: the interface with address %s has no link; connect the cable or Wi-Fi",
                   name_.c_str(), ipv4_text(ntohl(from.sin_addr.s_addr)).c_str());
  }
  return {};
}

Result<void> UdpRadio::check_usable() const {
  if (lost_) return *lost_;
  if (socket_.is_open()) return {};
  return failure(ErrorCode::kDisconnected, "%s: not open", name_.c_str());
}

void UdpRadio::add_routes(std::size_t receiver, RadioRoutes& out) const {
  if (!socket_.is_open()) return;
  for_each_endpoint(receiver, [&](std::size_t endpoint) {
    out.push_back({socket_.get(), true, at(endpoint).ipv4, at(endpoint).port});
  });
}

Result<void> UdpRadio::do_send(const Packet& packet, std::size_t receiver) {
  TOUCHLINE_TRY(check_usable());
  static_cast<void>(drain_errors());
  bool replaces = false;
  Result<void> result;
  for_each_endpoint(receiver, [&](std::size_t endpoint) {
    replaces = replaces || !waiting_[endpoint].empty();
    waiting_[endpoint] = packet;
    if (result.ok()) result = flush(endpoint);
  });
  if (!result.ok() || !replaces) return result;
  return failure(ErrorCode::kBusy, "%s: the interface takes no packets; a newer packet replaced an older one",
                 name_.c_str());
}

Result<void> UdpRadio::flush(std::size_t endpoint) {
  Packet& packet = waiting_[endpoint];
  const sockaddr_in to = socket_address(at(endpoint).ipv4, at(endpoint).port);
  const auto* const destination = reinterpret_cast<const sockaddr*>(&to);
  // A call fails without effect if a message about an earlier datagram has arrived meanwhile.
  for (std::size_t attempt = 0; attempt <= kMaxReceivers; ++attempt) {
    if (::sendto(socket_.get(), packet.data(), packet.size(), MSG_DONTWAIT | MSG_NOSIGNAL, destination, sizeof(to)) >=
        0) {
      packet.clear();
      is_stalled_ = false;
      return {};
    }
    const int error = errno;
    if (error == EAGAIN || error == ENOBUFS) break;
    if (error != EINTR && !drain_errors()) return fail("sending", error);
  }
  const Instant now = MonotonicClock::read();
  if (!std::exchange(is_stalled_, true)) waiting_since_ = now;
  if (now - waiting_since_ < kOutage) return {};
  lost_ = failure(ErrorCode::kDisconnected, "%s: the interface has taken no packet for %.1f s; does it have a link?",
                  name_.c_str(), seconds(kOutage));
  return *lost_;
}

/// Reads and counts the network's messages about datagrams. False: there is none.
bool UdpRadio::drain_errors() {
  bool found = false;
  for (std::size_t i = 0; i <= kMaxReceivers; ++i) {
    std::array<std::byte, 256> control{};
    msghdr header{};
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    if (::recvmsg(socket_.get(), &header, MSG_ERRQUEUE | MSG_DONTWAIT) < 0) break;
    found = true;
    count_unreachable(1);
  }
  return found;
}

bool UdpRadio::is_waiting() const {
  return std::any_of(waiting_.begin(), waiting_.end(), [](const Packet& packet) { return !packet.empty(); });
}

Result<Duration> UdpRadio::do_serve() {
  if (!is_waiting()) return Duration::max();
  TOUCHLINE_TRY(check_usable());
  for (std::size_t endpoint = 0; endpoint < waiting_.size(); ++endpoint) {
    if (!waiting_[endpoint].empty()) TOUCHLINE_TRY(flush(endpoint));
  }
  return is_waiting() ? kRetryPause : Duration::max();
}

bool UdpRadio::is_from_robot(std::uint32_t sender) const {
  return std::any_of(endpoints_.begin(), endpoints_.end(),
                     [&](const UdpEndpoint& endpoint) { return endpoint.exists() && endpoint.ipv4 == sender; });
}

Result<std::size_t> UdpRadio::do_receive(std::span<std::byte> into) {
  TOUCHLINE_TRY(check_usable());
  std::size_t received = 0;
  for (int i = 0; i < kMaxDatagrams; ++i) {
    sockaddr_in from{};
    const std::span<std::byte> rest = into.subspan(received);
    iovec part{rest.data(), rest.size()};
    msghdr header{};
    header.msg_name = &from;
    header.msg_namelen = sizeof(from);
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    // The first datagram may be as long as `into`; others are left for the next call if they might not fit.
    if (received > 0 && rest.size() < kMaxPacketBytes) break;
    const ssize_t size = ::recvmsg(socket_.get(), &header, MSG_DONTWAIT);
    if (size < 0) {
      if (errno == EAGAIN) break;
      if (errno == EINTR || drain_errors()) continue;
      return fail("receiving", errno);
    }
    const bool is_complete = (header.msg_flags & MSG_TRUNC) == 0;
    if (is_complete && is_from_robot(ntohl(from.sin_addr.s_addr))) received += static_cast<std::size_t>(size);
  }
  return received;
}

Result<void> UdpRadio::do_drain(Instant deadline) {
  for (;;) {
    TOUCHLINE_TRY(check_usable());
    TOUCHLINE_TRY(do_serve());
    int queued = 0;
    if (::ioctl(socket_.get(), TIOCOUTQ, &queued) != 0) queued = 0;
    if (!is_waiting() && queued == 0) return {};
    const Instant now = MonotonicClock::read();
    if (now >= deadline) break;
    MonotonicClock::wait_for(std::min(deadline, now + kDrainPause));
  }
  return failure(ErrorCode::kTimeout, "%s: not all packets were sent before the deadline", name_.c_str());
}

void UdpRadio::do_close() {
  socket_.reset();
  lost_.reset();
  for (Packet& packet : waiting_) packet.clear();
  is_stalled_ = false;
}

Error UdpRadio::fail(const char* doing, int error) noexcept {
  lost_ = failure(network_error_code(error), "%s: %s failed: %s", name_.c_str(), doing, system_text(error));
  return *lost_;
}

}  // namespace touchline::hal
