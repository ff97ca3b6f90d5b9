#include "tests/console/socket_client.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <array>
#include <cerrno>

namespace touchline::console {
namespace {

std::string request_text(std::string_view method, std::string_view path, std::string_view headers,
                         ServerAddress server) {
  std::string text = std::string(method) + " " + std::string(path) + " HTTP/1.1\r\n";
  if (headers.find("Host:") == std::string_view::npos)
    text += "Host: " + std::string(server.host) + ":" + std::to_string(server.port) + "\r\n";
  return text + std::string(headers);
}

int status_of(const std::string& head) {
  constexpr std::size_t kStatusAt = std::string_view("HTTP/1.1 ").size();
  return head.size() < kStatusAt + 3 ? 0 : std::atoi(head.substr(kStatusAt, 3).c_str());
}

}  // namespace

SocketClient::SocketClient(ServerAddress server) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const timeval limit{30, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(server.port);
  ::inet_pton(AF_INET, server.host, &address.sin_addr);
  if (server.from != nullptr) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    ::inet_pton(AF_INET, server.from, &own.sin_addr);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof(own)), 0);
  }
  EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
}

SocketClient::~SocketClient() { ::close(socket_); }

bool SocketClient::is_open() const {
  char byte = 0;
  const ssize_t size = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return size > 0 || (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK));
}

void SocketClient::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

void SocketClient::shrink_window() const {
  const int bytes = 1;  // the kernel raises it to its minimum
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
}

bool SocketClient::receive_more() {
  std::array<char, 65536> buffer{};
  const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), 0);
  if (size <= 0) return false;
  received_.append(buffer.data(), static_cast<std::size_t>(size));
  return true;
}

std::string SocketClient::read_until(std::string_view end) {
  std::size_t found = std::string::npos;
  while (end.empty() || (found = received_.find(end)) == std::string::npos) {
    if (!receive_more()) return std::exchange(received_, {});
  }
  const std::string text = received_.substr(0, found + end.size());
  received_.erase(0, text.size());
  return text;
}

std::string SocketClient::read(std::size_t size) {
  while (received_.size() < size) {
    if (!receive_more()) break;
  }
  const std::string bytes = received_.substr(0, size);
  received_.erase(0, bytes.size());
  return bytes;
}

HttpAnswer get(ServerAddress server, std::string_view path, std::string_view headers, std::string_view method) {
  SocketClient client(server);
  client.send(request_text(method, path, headers, server) + "Connection: close\r\n\r\n");
  HttpAnswer answer;
  answer.head = client.read_until("\r\n\r\n");
  answer.status = status_of(answer.head);
  answer.body = client.read_until();
  return answer;
}

int SocketMessage::close_code() const {
  if (opcode != 8 || payload.size() < 2) return 0;
  return static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
}

SocketPage::SocketPage(ServerAddress server, std::string_view headers, std::string_view path,
                       std::string_view subprotocol)
    : client_(server) {
  std::string text = request_text("GET", path, headers, server) +
                     "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  if (!subprotocol.empty()) text += "Sec-WebSocket-Protocol: " + std::string(subprotocol) + "\r\n";
  client_.send(text + "\r\n");
  const std::string head = client_.read_until("\r\n\r\n");
  status_ = status_of(head);
  // The example of RFC 6455, section 1.3.
  EXPECT_TRUE(status_ != 101 || head.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos) << head;
}

void SocketPage::send_frame(int opcode, std::string_view payload, bool is_final) {
  std::string frame(1, static_cast<char>((is_final ? 0x80 : 0) | opcode));
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else if (payload.size() < 65536) {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(payload.size() >> 8);
    frame += static_cast<char>(payload.size() & 255);
  } else {
    frame += static_cast<char>(0x80 | 127);
    for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(payload.size() >> shift & 255);
  }
  const std::string mask = "\x12\x34\x56\x78";
  frame += mask;
  for (std::size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(payload[i] ^ mask[i % 4]);
  client_.send(frame);
}

SocketMessage SocketPage::read() {
  for (;;) {
    const std::string head = client_.read(2);
    if (head.size() < 2) return {};
    const auto byte = [](char c) { return static_cast<std::size_t>(static_cast<unsigned char>(c)); };
    std::size_t size = byte(head[1]) & 127;
    if (size >= 126) {
      const std::string more = client_.read(size == 126 ? 2 : 8);
      size = 0;
      for (const char c : more) size = size << 8 | byte(c);
    }
    SocketMessage message{static_cast<int>(byte(head[0]) & 15), client_.read(size)};
    if (message.payload.size() < size) return {};
    if (message.opcode != 9) return message;
    send_frame(10, message.payload);
  }
}

std::optional<std::string> SocketPage::read_type(std::string_view type) {
  const std::string begin = "{\"type\":\"" + std::string(type) + "\"";
  for (;;) {
    SocketMessage message = read();
    if (message.opcode == 0 || message.opcode == 8) return std::nullopt;
    if (message.opcode == 1 && message.payload.starts_with(begin)) return message.payload;
  }
}

}  // namespace touchline::console
