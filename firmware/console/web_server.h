#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "firmware/console/access.h"
#include "firmware/console/hub.h"
#include "hal/result.h"

namespace touchline::console {

/// Time limits after which a connection is closed.
struct Patience {
  Duration unread = std::chrono::seconds(10);  // the other side does not read what is sent
  // Times of silence after which the other side is asked, and after which the connection is closed.
  std::uint16_t ask_after_s = 5, close_after_s = 15;
  unsigned request_s = 5;  // the first request does not arrive
};

struct WebServerSettings {
  std::string address;     // IPv4 address in numbers
  std::uint16_t port = 0;  // 0: a free port is chosen
  std::string page_folder;
  AccessRules access;
  Patience patience{};
};

/// Serves HTTP and WebSocket (docs/console-protocol.md) with libwebsockets. Only one thread may use it, except for
/// wake().
class WebServer {
 public:
  /// `hub` must outlive the server.
  WebServer(Hub& hub, WebServerSettings settings);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// kIo: the address cannot be used; the message names it.
  Result<void> open();
  /// Returns the port; call it after open().
  [[nodiscard]] std::uint16_t port() const;
  /// Waits until something happens or is due, and handles it.
  void serve();
  /// Ends the wait in serve(); any thread may call it after open().
  void wake();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace touchline::console
