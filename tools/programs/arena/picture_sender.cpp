#include "tools/programs/arena/picture_sender.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "hal/linux/network/network_address.h"
#include "hal/linux/system_error.h"

namespace touchline::arena {
namespace {

// A receiver that plays takes each picture at once. One that stands in a debugger may connect again.
constexpr int kSendPatience_ms = 1000;

}  // namespace

Result<void> PictureSender::open(const hal::TcpAddress& address, const hal::StreamHello& hello) {
  hello_ = hello;
  TOUCHLINE_TRY_ASSIGN(listener_, hal::listen_tcp(address));
  return {};
}

void PictureSender::accept(int patience_ms) {
  pollfd watched{listener_.get(), POLLIN, 0};
  if (::poll(&watched, 1, patience_ms) <= 0) return;
  sockaddr_in from{};
  socklen_t size = sizeof(from);
  hal::Descriptor socket(
      ::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return;
  if (receiver_.is_open()) drop("another one has connected");
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  receiver_ = std::move(socket);
  std::printf("receiver of pictures: %s has connected\n", hal::ipv4_text(ntohl(from.sin_addr.s_addr)).c_str());
  std::fflush(stdout);
  send_all(hal::encode(hello_));
}

void PictureSender::drop(const char* why) {
  receiver_.reset();
  std::printf("receiver of pictures: gone: %s\n", why);
  std::fflush(stdout);
}

bool PictureSender::wait_for_request(int patience_ms) {
  if (!receiver_.is_open()) return false;
  pollfd watched{receiver_.get(), POLLIN, 0};
  if (::poll(&watched, 1, patience_ms) <= 0) return false;
  std::byte request{};
  const ssize_t count = ::recv(receiver_.get(), &request, 1, MSG_DONTWAIT);
  if (count == 1 && request == hal::kNextPicture) return true;
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  drop(count == 0   ? "it has closed the connection"
       : count == 1 ? "it sent something that is no request"
                    : hal::system_text(errno));
  return false;
}

bool PictureSender::send_all(std::span<const std::byte> bytes) {
  while (!bytes.empty() && receiver_.is_open()) {
    const ssize_t count = ::send(receiver_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      continue;
    }
    if (errno == EINTR) continue;
    pollfd watched{receiver_.get(), POLLOUT, 0};
    if (errno != EAGAIN) {
      drop(hal::system_text(errno));
    } else if (::poll(&watched, 1, kSendPatience_ms) == 0) {
      drop("it took nothing for a second");
    }
  }
  return bytes.empty();
}

void PictureSender::send(const hal::PictureHeader& header, std::span<const std::byte> picture) {
  if (send_all(hal::encode(header))) send_all(picture);
}

}  // namespace touchline::arena
