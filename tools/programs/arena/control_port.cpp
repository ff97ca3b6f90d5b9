#include "tools/programs/arena/control_port.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/network/arena_message.h"
#include "hal/linux/network/udp_socket.h"

namespace touchline::arena {
namespace {

// The places of two teams of eleven need 2 KB. A longer datagram is cut off, and is then no request.
constexpr std::size_t kMaxRequestBytes = 8192;

Result<void> carry_out(std::string_view text, ArenaObjects& objects) {
  TOUCHLINE_TRY_ASSIGN(const ArenaRequest request, network::decode_arena_request(text));
  return objects.control(request);
}

}  // namespace

Result<void> ControlPort::open(const hal::NetworkAddress& address) {
  const std::string name = address.text();
  if (address.kind != hal::NetworkAddress::Kind::kUdp) {
    return failure(ErrorCode::kOutOfRange, "--control %s: has to be udp://ADDRESS:PORT", name.c_str());
  }
  TOUCHLINE_TRY_ASSIGN(hal::Descriptor socket, hal::udp_socket(name));
  const sockaddr_in at = hal::socket_address(address.ipv4, address.port);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)) != 0) {
    return hal::network_error(name, "binding", errno);
  }
  socket_ = std::move(socket);
  return {};
}

void ControlPort::serve(ArenaObjects& objects) {
  if (!socket_.is_open()) return;
  std::array<char, kMaxRequestBytes> text;
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    const ssize_t count =
        ::recvfrom(socket_.get(), text.data(), text.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0 && (errno == EINTR || errno == ECONNREFUSED)) continue;
    if (count < 0) return;
    const Result<void> done = carry_out({text.data(), static_cast<std::size_t>(count)}, objects);
    const std::string answer = done.ok() ? "ok" : done.text();
    static_cast<void>(::sendto(socket_.get(), answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                               reinterpret_cast<const sockaddr*>(&from), size));
  }
}

}  // namespace touchline::arena
