#include "hal/linux/network/tcp_socket.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <utility>

#include "hal/linux/network/udp_socket.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

constexpr std::string_view kTcp = "tcp://";
constexpr int kTcpSocketType = SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC;

Error refusal(const TcpAddress& address, ErrorCode code, const char* doing, int error) {
  return failure(code, "%s: %s failed: %s", address.text().c_str(), doing, system_text(error));
}

// Returns the errno of a connection in progress.
int wait_for_connection(const Descriptor& socket, int patience_ms) {
  pollfd watched{socket.get(), POLLOUT, 0};
  const int ready = ::poll(&watched, 1, patience_ms);
  if (ready == 0) return ETIMEDOUT;
  if (ready < 0) return errno;
  int error = 0;
  socklen_t size = sizeof(error);
  return ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

}  // namespace

std::string TcpAddress::text() const { return std::string(kTcp) + ipv4_text(ipv4) + ":" + std::to_string(port); }

Result<TcpAddress> parse_tcp_address(std::string_view text) {
  if (!text.starts_with(kTcp)) {
    return failure(ErrorCode::kOutOfRange, "\"%s\": expected tcp://ADDRESS:PORT", std::string(text).c_str());
  }
  // A listener may listen at all addresses of its computer.
  constexpr std::string_view kAny = "0.0.0.0:";
  const std::string_view rest = text.substr(kTcp.size());
  const bool is_any = rest.starts_with(kAny);
  const std::string port = "localhost:" + std::string(rest.substr(is_any ? kAny.size() : 0));
  TOUCHLINE_TRY_ASSIGN(const NetworkAddress address, parse_udp_destination(is_any ? std::string_view(port) : rest, 0));
  return TcpAddress{is_any ? INADDR_ANY : address.ipv4, address.port};
}

Result<Descriptor> listen_tcp(const TcpAddress& address) {
  const auto refuse = [&](const char* doing) { return refusal(address, open_error(errno), doing, errno); };
  Descriptor socket(::socket(AF_INET, kTcpSocketType, 0));
  if (!socket.is_open()) return refuse("making a socket");
  const int on = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  const sockaddr_in at = socket_address(address.ipv4, address.port);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)) != 0) return refuse("binding");
  if (::listen(socket.get(), 2) != 0) return refuse("listening");
  return socket;
}

std::uint16_t local_port(const Descriptor& socket) {
  sockaddr_in at{};
  socklen_t size = sizeof(at);
  if (::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&at), &size) != 0) return 0;
  return ntohs(at.sin_port);
}

Result<Descriptor> connect_tcp(const TcpAddress& address, int patience_ms) {
  Descriptor socket(::socket(AF_INET, kTcpSocketType, 0));
  if (!socket.is_open()) return refusal(address, open_error(errno), "making a socket", errno);
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  const sockaddr_in to = socket_address(address.ipv4, address.port);
  int error = ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0 ? 0 : errno;
  if (error == EINPROGRESS) error = wait_for_connection(socket, patience_ms);
  if (error != 0) return refusal(address, ErrorCode::kNotFound, "connecting", error);
  return socket;
}

}  // namespace touchline::hal
