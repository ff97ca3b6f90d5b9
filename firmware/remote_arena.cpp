#include "firmware/remote_arena.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <utility>

#include "hal/linux/network/udp_socket.h"

namespace touchline {
namespace {

// An arena in real time answers within some milliseconds. Whoever asks looks after Stop buttons, too.
constexpr int kPatience_ms = 100;

}  // namespace

Result<void> RemoteArena::connect() {
  if (socket_.is_open()) return {};
  TOUCHLINE_TRY_ASSIGN(hal::Descriptor socket, hal::udp_socket(name_));
  const sockaddr_in to = hal::socket_address(address_.ipv4, address_.port);
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof(to)) != 0) {
    return hal::network_error(name_, "connecting", errno);
  }
  socket_ = std::move(socket);
  return {};
}

Result<void> RemoteArena::ask(const std::string& request) {
  TOUCHLINE_TRY(connect());
  std::array<char, 512> answer{};
  // Answers that came too late, and the network's message that nobody listened.
  while (::recv(socket_.get(), answer.data(), answer.size(), MSG_DONTWAIT) >= 0 || errno == ECONNREFUSED) {
  }
  if (::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL) < 0) {
    return hal::network_error(name_, "sending", errno);
  }
  pollfd watched{socket_.get(), POLLIN, 0};
  if (::poll(&watched, 1, kPatience_ms) <= 0) {
    return failure(ErrorCode::kTimeout, "the arena at %s has not answered; it may still do what was asked",
                   name_.c_str());
  }
  const ssize_t count = ::recv(socket_.get(), answer.data(), answer.size(), MSG_DONTWAIT);
  if (count < 0) {
    return failure(ErrorCode::kNotFound, "no arena takes requests at %s (touchline-arena serve --control)",
                   name_.c_str());
  }
  const std::string_view text(answer.data(), static_cast<std::size_t>(count));
  if (text == "ok") return {};
  return failure(ErrorCode::kInconsistent, "%.*s", static_cast<int>(text.size()), text.data());
}

}  // namespace touchline
