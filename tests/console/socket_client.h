#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace touchline::console {

/// Address of a server, by default on this computer.
struct ServerAddress {
  ServerAddress(std::uint16_t port_, const char* host_ = "127.0.0.1",  // NOLINT(google-explicit-constructor)
                const char* from_ = nullptr)
      : port(port_), host(host_), from(from_) {}
  std::uint16_t port;
  const char* host;  // IPv4 address in numbers
  const char* from;  // the client's own address; null: any
};

/// A client that shares no code with the server: HTTP/1.1 and WebSocket (RFC 6455) on a blocking socket. A wait ends
/// after half a minute, which no working test reaches.
class SocketClient {
 public:
  explicit SocketClient(ServerAddress server);
  ~SocketClient();
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;

  void send(std::string_view bytes) const;
  /// Returns whether the other side has not closed the connection. Never waits.
  [[nodiscard]] bool is_open() const;
  /// Makes the receive buffer as small as the kernel permits, so that the TCP window closes soon when nothing is read.
  void shrink_window() const;
  /// Returns everything until the other side closes the connection, or until `end` has arrived.
  std::string read_until(std::string_view end = {});
  /// Reads this number of bytes; fewer if the connection ends.
  std::string read(std::size_t size);

 private:
  bool receive_more();

  int socket_ = -1;
  std::string received_;
};

struct HttpAnswer {
  int status = 0;
  std::string head, body;
};
/// `headers`: further lines, each with its line end; a Host line replaces the usual one.
HttpAnswer get(ServerAddress server, std::string_view path, std::string_view headers = {},
               std::string_view method = "GET");

/// A frame of the WebSocket protocol.
struct SocketMessage {
  int opcode = 0;  // 1: text, 2: binary, 8: close; 0: the connection has ended
  std::string payload;

  /// Returns the code of a close frame; 0 if there is none.
  [[nodiscard]] int close_code() const;
};

class SocketPage {
 public:
  /// Opens the WebSocket. `headers` as for get().
  explicit SocketPage(ServerAddress server, std::string_view headers = {}, std::string_view path = "/ws",
                      std::string_view subprotocol = "touchline.1");
  /// Returns the status of the handshake; 101: the WebSocket is open.
  [[nodiscard]] int status() const { return status_; }
  void send_text(std::string_view text) { send_frame(1, text); }
  /// `is_final`: false for a message that continues in the next frame (opcode 0).
  void send_frame(int opcode, std::string_view payload, bool is_final = true);
  /// Returns the next message. Pings are answered.
  SocketMessage read();
  /// Returns the next text of this type; other texts, and pictures, are skipped. Returns nullopt if the connection has
  /// ended.
  std::optional<std::string> read_type(std::string_view type);
  SocketClient& socket() { return client_; }

 private:
  SocketClient client_;
  int status_ = 0;
};

}  // namespace touchline::console
