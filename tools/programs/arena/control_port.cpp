#include "tools/programs/arena/control_port.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <string>
#include <string_view>

#include "firmware/network/arena_message.h"
#include "hal/linux/network/network_address.h"
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

Result<void> ControlPort::open(const std::string& address) {
  const Result<hal::NetworkAddress> at = hal::parse_network_address(address);
  if (!at.ok() || at.value().kind != hal::NetworkAddress::Kind::kUdp) {
    return failure(ErrorCode::kOutOfRange, "--control %s: expected udp://ADDRESS:PORT", address.c_str());
  }
  TOUCHLINE_TRY_ASSIGN(socket_, hal::bound_udp_socket(at.value()));
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
