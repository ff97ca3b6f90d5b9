#include "tools/programs/latency/console_reader.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <list>
#include <string>
#include <string_view>
#include <vector>

#include "hal/linux/monotonic_clock.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {
namespace {

constexpr std::string_view kWatch = R"({"type":"watch","state_hz":60,"picture":{"rate_hz":60}})";
// Offset of the number, and size of the header, in a picture's message (docs/console-protocol.md).
constexpr std::size_t kNumberOffset = 16, kPictureHeader = 32;
// Opcodes of RFC 6455.
constexpr unsigned kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10;
constexpr std::size_t kReadBytes = std::size_t{256} * 1024;

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

/// A client with WebSocket (RFC 6455).
class ConsoleClient {
 public:
  ConsoleClient() = default;
  ~ConsoleClient() {
    if (socket_ >= 0) ::close(socket_);
  }
  ConsoleClient(const ConsoleClient&) = delete;
  ConsoleClient& operator=(const ConsoleClient&) = delete;

  [[nodiscard]] bool open(std::uint16_t port) {
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int at_once = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return false;
    // The key can be any 16 bytes; this client does not check the server's answer to it.
    return send_bytes(
        "GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: dG91Y2hsaW5lLWxhdGVuY3k=\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Protocol: touchline.1\r\n\r\n");
  }
  [[nodiscard]] int socket() const { return socket_; }
  /// Returns whether the server has sent its greeting.
  [[nodiscard]] bool is_ready() const { return is_ready_; }
  /// Reads the bytes that have arrived. Returns false if the connection has ended.
  [[nodiscard]] bool receive(ConsoleTraffic& traffic) {
    const std::size_t before = received_.size();
    received_.resize(before + kReadBytes);
    const ssize_t count = ::recv(socket_, received_.data() + before, kReadBytes, 0);
    received_.resize(before + static_cast<std::size_t>(count > 0 ? count : 0));
    if (count <= 0) return false;
    traffic.bytes += static_cast<std::uint64_t>(count);
    if (!is_open_ && !finish_handshake()) return true;
    std::size_t used = 0;
    for (;;) {
      const std::string_view rest = std::string_view(received_).substr(used);
      const std::size_t length = frame_bytes(rest);
      if (length == 0 || length > rest.size()) break;
      if (!obey(rest.substr(0, length), traffic)) return false;
      used += length;
    }
    received_.erase(0, used);
    return true;
  }

 private:
  // Returns the number of bytes of header and content; 0 if the header is not complete. A server's frames have no mask.
  static std::size_t frame_bytes(std::string_view bytes) {
    if (bytes.size() < 2) return 0;
    const std::size_t header = header_bytes(bytes);
    if (bytes.size() < header) return 0;
    return header + (header == 2 ? big_endian(bytes.substr(1, 1)) : big_endian(bytes.substr(2, header - 2)));
  }
  static std::size_t header_bytes(std::string_view bytes) { return bytes[1] == 126 ? 4 : bytes[1] == 127 ? 10 : 2; }

  bool finish_handshake() {
    const std::size_t end = received_.find("\r\n\r\n");
    if (end == std::string::npos) return false;
    is_open_ = received_.starts_with("HTTP/1.1 101");
    received_.erase(0, end + 4);
    return is_open_ && send_frame(kText, kWatch);
  }

  bool obey(std::string_view frame, ConsoleTraffic& traffic) {
    const unsigned opcode = static_cast<unsigned char>(frame[0]) & 15U;
    const std::string_view content = frame.substr(header_bytes(frame));
    if (opcode == kClose) return false;
    if (opcode == kPing) return send_frame(kPong, content);
    if (opcode == kBinary && content.size() >= kPictureHeader) {
      ++traffic.pictures;
      std::uint64_t number = 0;
      for (std::size_t i = 8; i > 0; --i)
        number = number << 8 | static_cast<unsigned char>(content[kNumberOffset + i - 1]);
      return send_frame(kText, R"({"type":"seen","number":)" + std::to_string(number) + "}");
    }
    // This client asks nothing that has an answer, so an answer means that the watch was refused.
    if (content.starts_with(R"({"type":"answer")")) return false;
    if (content.starts_with(R"({"type":"state")")) ++traffic.states;
    is_ready_ = is_ready_ || content.starts_with(R"({"type":"hello")");
    return true;
  }

  // Sends a frame of less than 126 bytes. A client's frames need a mask; it consists of zeros here.
  [[nodiscard]] bool send_frame(unsigned opcode, std::string_view content) const {
    std::string frame{static_cast<char>(0x80U | opcode), static_cast<char>(0x80U | content.size())};
    frame.append(4, '\0').append(content);
    return send_bytes(frame);
  }
  [[nodiscard]] bool send_bytes(std::string_view bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }

  int socket_ = -1;
  bool is_open_ = false, is_ready_ = false;
  std::string received_;
};

bool has_input(const pollfd& entry) { return (entry.revents & (POLLIN | POLLHUP | POLLERR)) != 0; }

}  // namespace

int read_console(std::uint16_t port, unsigned clients) {
  std::list<ConsoleClient> all;
  std::vector<pollfd> sockets{{STDIN_FILENO, POLLIN, 0}};
  for (unsigned i = 0; i < clients; ++i) {
    ConsoleClient& client = all.emplace_back();
    if (!client.open(port)) return kExitDeviceFailure;
    sockets.push_back({client.socket(), POLLIN, 0});
  }
  ConsoleTraffic traffic;
  Instant begin{};
  while (!has_input(sockets[0])) {
    if (::poll(sockets.data(), sockets.size(), -1) < 0) return kExitDeviceFailure;
    std::size_t ready = 0, i = 1;
    for (ConsoleClient& client : all) {
      if (has_input(sockets[i++]) && !client.receive(traffic)) return kExitDeviceFailure;
      if (client.is_ready()) ++ready;
    }
    if (begin != Instant{} || ready < all.size()) continue;
    begin = hal::MonotonicClock::read();
    traffic = {};
    std::fputs("ready\n", stdout);
    std::fflush(stdout);
  }
  const double elapsed_s = seconds(hal::MonotonicClock::read() - begin);
  std::printf("%llu states, %llu pictures, %llu bytes, %.6f s\n", static_cast<unsigned long long>(traffic.states),
              static_cast<unsigned long long>(traffic.pictures), static_cast<unsigned long long>(traffic.bytes),
              elapsed_s);
  return kExitOk;
}

}  // namespace touchline::latency
