#include "tests/console/setup_peer.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <cstring>
#include <utility>

namespace touchline::console {
namespace {

constexpr int kWaitMs = 30000;

bool becomes_readable(int descriptor) {
  pollfd entry{descriptor, POLLIN, 0};
  return ::poll(&entry, 1, kWaitMs) > 0;
}

std::uint32_t length_of(std::string_view bytes) {
  std::uint32_t length = 0;
  for (std::size_t i = 4; i-- > 0;) length = length << 8 | static_cast<unsigned char>(bytes[i]);
  return length;
}

}  // namespace

std::string length_bytes(std::uint32_t length) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(length >> (8 * i) & 0xff));
  return bytes;
}

SetupPeer::SetupPeer(std::string path) : path_(std::move(path)) {
  listener_.reset(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  EXPECT_LT(path_.size(), sizeof(address.sun_path));
  path_.copy(address.sun_path, sizeof(address.sun_path) - 1);
  EXPECT_EQ(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0)
      << std::strerror(errno);
  EXPECT_EQ(::listen(listener_.get(), 1), 0);
}

SetupPeer::~SetupPeer() { leave(); }

void SetupPeer::leave() {
  if (listener_.is_open()) ::unlink(path_.c_str());
  listener_.reset();
  connection_.reset();
}

bool SetupPeer::accept() {
  if (!becomes_readable(listener_.get())) return false;
  connection_.reset(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
  return connection_.is_open();
}

void SetupPeer::send_bytes(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(connection_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

void SetupPeer::send(std::string_view text, std::string_view binary) {
  send_bytes(length_bytes(static_cast<std::uint32_t>(text.size())) +
             length_bytes(static_cast<std::uint32_t>(binary.size())) + std::string(text) + std::string(binary));
}

void SetupPeer::end_sending() { ::shutdown(connection_.get(), SHUT_WR); }

std::string SetupPeer::read_bytes(std::size_t size) {
  std::string bytes;
  while (bytes.size() < size && becomes_readable(connection_.get())) {
    std::string part(size - bytes.size(), '\0');
    const ssize_t got = ::recv(connection_.get(), part.data(), part.size(), 0);
    if (got <= 0) break;
    bytes.append(part, 0, static_cast<std::size_t>(got));
  }
  return bytes;
}

SetupPeer::Message SetupPeer::read() {
  const std::string lengths = read_bytes(8);
  if (lengths.size() < 8) return {};
  const std::string text = read_bytes(length_of(lengths));
  return {nlohmann::json::parse(text, nullptr, false), read_bytes(length_of(std::string_view(lengths).substr(4)))};
}

SetupPeer::Message SetupPeer::read_type(std::string_view type) {
  for (;;) {
    Message message = read();
    if (!message.text.is_object() || message.text["type"] == type) return message;
  }
}

}  // namespace touchline::console
