#include "hal/linux/network/unix_output.h"

#include <sys/socket.h>
#include <algorithm>
#include <cerrno>

namespace touchline::hal {
namespace {

// Returns the number of bytes that the socket took; -1 if the other side has closed the connection.
ssize_t send_some(const Descriptor& socket, std::span<const std::byte> bytes) {
  ssize_t sent = 0;
  do {
    sent = ::send(socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent < 0 && errno == EAGAIN ? 0 : sent;
}

}  // namespace

Result<void> UnixOutput::send(std::span<const std::byte> message) {
  accept_clients();
  for (Client& client : clients_) {
    if (client.socket.is_open()) send_to(client, message);
  }
  return {};
}

void UnixOutput::accept_clients() {
  for (Descriptor socket = listener_.accept(); socket.is_open(); socket = listener_.accept()) {
    const auto free =
        std::find_if(clients_.begin(), clients_.end(), [](const Client& c) { return !c.socket.is_open(); });
    if (free == clients_.end()) continue;  // leaving the scope closes the connection
    free->socket = std::move(socket);
    free->unsent.clear();
  }
}

void UnixOutput::send_to(Client& client, std::span<const std::byte> line) {
  const auto send_all = [&](std::span<const std::byte> bytes) {
    const ssize_t sent = send_some(client.socket, bytes);
    if (sent < 0) client.socket.reset();
    return bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  };
  if (!client.unsent.empty()) {
    const std::size_t left = send_all(client.unsent).size();
    client.unsent.erase(client.unsent.begin(), client.unsent.end() - static_cast<std::ptrdiff_t>(left));
  }
  if (!client.socket.is_open()) return;
  if (!client.unsent.empty()) {
    ++dropped_;
    return;
  }
  const std::span<const std::byte> left = send_all(line);
  if (left.size() == line.size()) {
    ++dropped_;
  } else {
    client.unsent.assign(left.begin(), left.end());
  }
}

void UnixOutput::close() {
  for (Client& client : clients_) client.socket.reset();
  listener_.close();
}

}  // namespace touchline::hal
