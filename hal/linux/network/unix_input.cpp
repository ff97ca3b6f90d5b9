#include "hal/linux/network/unix_input.h"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <algorithm>
#include <cerrno>

#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

bool watch(const Descriptor& poll, int descriptor) {
  epoll_event event{};
  event.events = EPOLLIN;
  return ::epoll_ctl(poll.get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
}

}  // namespace

Result<void> UnixInput::open() {
  close();
  TOUCHLINE_TRY(listener_.open(path_));
  poll_.reset(::epoll_create1(EPOLL_CLOEXEC));
  if (poll_.is_open() && watch(poll_, listener_.descriptor())) return {};
  const int error = errno;
  close();
  return failure(ErrorCode::kIo, "unix://%s: waiting for programs failed: %s", path_.c_str(), system_text(error));
}

void UnixInput::close() {
  for (Client& client : clients_) client.socket.reset();
  poll_.reset();
  listener_.close();
}

void UnixInput::accept_clients() {
  for (Descriptor socket = listener_.accept(); socket.is_open(); socket = listener_.accept()) {
    const auto free =
        std::find_if(clients_.begin(), clients_.end(), [](const Client& c) { return !c.socket.is_open(); });
    if (free == clients_.end() || !watch(poll_, socket.get())) continue;  // leaving the scope closes the connection
    *free = {std::move(socket), {}, false};
  }
}

Result<std::optional<ReceivedMessage>> UnixInput::receive(std::span<std::byte> into) {
  accept_clients();
  for (std::size_t i = 0; i < kMaxClients; ++i) {
    const auto number = static_cast<std::uint16_t>(next_client_);
    Client& client = clients_[next_client_];
    next_client_ = (next_client_ + 1) % kMaxClients;
    if (!client.socket.is_open()) continue;
    read_from(client);
    if (std::optional<ReceivedMessage> message = take_line(client, into)) {
      message->port = number;
      return message;
    }
  }
  return std::optional<ReceivedMessage>();
}

void UnixInput::read_from(Client& client) {
  const std::size_t before = client.received.size();
  if (before == kMaxLineBytes) return;
  client.received.resize(kMaxLineBytes);
  ssize_t size = 0;
  do {
    size = ::recv(client.socket.get(), client.received.data() + before, kMaxLineBytes - before, 0);
  } while (size < 0 && errno == EINTR);
  const bool is_gone = size == 0 || (size < 0 && errno != EAGAIN);
  client.received.resize(before + static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  // Complete lines that arrived before the end are still delivered.
  const bool has_line =
      std::find(client.received.begin(), client.received.end(), std::byte{'\n'}) != client.received.end();
  if (is_gone && !has_line) client.socket.reset();
}

std::optional<ReceivedMessage> UnixInput::take_line(Client& client, std::span<std::byte> into) {
  const auto end = std::find(client.received.begin(), client.received.end(), std::byte{'\n'});
  if (end == client.received.end()) {
    if (client.received.size() == kMaxLineBytes) {
      client.too_long = true;
      client.received.clear();
    }
    return std::nullopt;
  }
  ReceivedMessage message;
  message.is_local = true;
  const auto size = static_cast<std::size_t>(end - client.received.begin());
  message.size = std::min(size, into.size());
  message.is_complete = size <= into.size() && !client.too_long;
  std::copy_n(client.received.begin(), message.size, into.begin());
  client.received.erase(client.received.begin(), end + 1);
  client.too_long = false;
  return message;
}

}  // namespace touchline::hal
