#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "firmware/console/access.h"
#include "firmware/console/hub.h"
#include "hal/result.h"

namespace touchline::console {

/// When a connection is given up.
struct Patience {
  Duration unread = std::chrono::seconds(10);  // its other side does not read what waits for it
  // Times of silence after which the other side is asked, and after which the connection is closed because the other
  // side may be gone.
  std::uint16_t ask_after_s = 5, close_after_s = 15;
  unsigned request_s = 5;  // its first request does not arrive
};

struct WebServerSettings {
  std::string address;     // in numbers
  std::uint16_t port = 0;  // 0: a free one
  std::string page_folder;
  AccessRules access;
  Patience patience{};
};

/// HTTP and WebSocket (docs/console-protocol.md) with libwebsockets. For one thread, but for wake().
class WebServer {
 public:
  /// `hub` must outlive the server.
  WebServer(Hub& hub, WebServerSettings settings);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// kIo: the address cannot be used; the message names it.
  Result<void> open();
  /// After open().
  [[nodiscard]] std::uint16_t port() const;
  /// Waits until something happens or has to be done, and does it.
  void serve();
  /// Ends the wait in serve(); for any thread, after open().
  void wake();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace touchline::console
