#include "firmware/console/web_server.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <exception>
#include <utility>
#include <vector>

#include "firmware/console/protocol.h"
#include "firmware/console/web_server_parts.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

// Periods of tick(). While somebody watches, the period is a small part of a frame's; otherwise it is short enough to
// notice a silent driver in time.
constexpr Duration kWatchedPeriod = 8ms, kIdlePeriod = 200ms;
// Enough for clients, Stop connections, visitors (web_visitors.cpp), five long requests, some descriptors of
// libwebsockets itself, and connections that are being closed.
constexpr unsigned kMaxDescriptors = 160;
// There are as many header buffers as connections, so that silent connections keep nobody waiting.
constexpr unsigned kHttpHeaderBytes = 4096, kHeaderPool = kMaxDescriptors;
constexpr int kKeepAliveS = 5;
constexpr std::size_t kReceiveBytes = 4096;

// The text of libwebsockets' last error, for the message about an address that cannot be used.
std::string& last_error() {
  static std::string text;
  return text;
}

// Headers that libwebsockets adds to every answer; it keeps their addresses. They say that the page needs no other
// site, and that no site may frame it.
const lws_protocol_vhost_options* safety_headers() {
  static const lws_protocol_vhost_options frame{nullptr, nullptr, "x-frame-options:", "DENY"};
  static const lws_protocol_vhost_options referrer{&frame, nullptr, "referrer-policy:", "no-referrer"};
  static const lws_protocol_vhost_options type{&referrer, nullptr, "x-content-type-options:", "nosniff"};
  static const lws_protocol_vhost_options resource{&type, nullptr, "cross-origin-resource-policy:", "same-origin"};
  static const lws_protocol_vhost_options content{
      &resource, nullptr, "content-security-policy:",
      "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; connect-src 'self'; "
      "frame-ancestors 'none'; base-uri 'none'; form-action 'none'; object-src 'none'"};
  return &content;
}

template <class Handle>
int guarded(lws* connection, const Handle& handle) {
  // libwebsockets makes some calls without a connection, before the context knows its user.
  lws_context* const context = connection != nullptr ? lws_get_context(connection) : nullptr;
  void* const user = context != nullptr ? lws_context_user(context) : nullptr;
  if (user == nullptr) return 0;
  try {
    return handle(user);
  } catch (const std::exception&) {  // out of memory: only this connection ends
    return -1;
  }
}

}  // namespace

std::string header_of(lws* connection, lws_token_indexes token) {
  std::array<char, 1024> text{};
  const int size = lws_hdr_copy(connection, text.data(), static_cast<int>(text.size()), token);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

WebServer::Implementation::Implementation(Hub& hub, WebServerSettings settings)
    : hub_(hub),
      settings_(std::move(settings)),
      files_(std::make_shared<const PageFiles>(settings_.page_folder)),
      idle_policy_{nullptr, 0, 0, settings_.patience.ask_after_s, settings_.patience.close_after_s, 0} {
  timer_.owner = this;
}

WebServer::Implementation::~Implementation() {
  if (context_ != nullptr) lws_context_destroy(context_);
}

namespace {

// Finds out whether the port is in use, because libwebsockets does not tell why it could not bind.
bool is_port_busy(const std::string& address, std::uint16_t port) {
  const int probe = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in wanted{};
  wanted.sin_family = AF_INET;
  wanted.sin_port = htons(port);
  const bool is_address = ::inet_pton(AF_INET, address.c_str(), &wanted.sin_addr) == 1;
  const int reuse = 1;  // as libwebsockets does: connections that are being closed do not count as use
  ::setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  const bool is_busy = probe >= 0 && is_address &&
                       ::bind(probe, reinterpret_cast<const sockaddr*>(&wanted), sizeof wanted) != 0 &&
                       errno == EADDRINUSE;
  if (probe >= 0) ::close(probe);
  return is_busy;
}

}  // namespace

Result<void> WebServer::Implementation::open() {
  constexpr lws_callback_function* kOnHttp = [](lws* connection, lws_callback_reasons reason, void*, void* in,
                                                std::size_t) {
    return guarded(connection,
                   [&](void* user) { return static_cast<Implementation*>(user)->on_http(connection, reason, in); });
  };
  constexpr lws_callback_function* kOnSocket = [](lws* connection, lws_callback_reasons reason, void*, void* in,
                                                  std::size_t size) {
    return guarded(connection, [&](void* user) {
      return static_cast<Implementation*>(user)->on_socket(connection, reason, in, size);
    });
  };
  static const std::array<lws_protocols, 6> protocols{
      {{"http", kOnHttp, 0, kReceiveBytes, 0, nullptr, 0},
       {kSubprotocol, kOnSocket, 0, kReceiveBytes, 0, nullptr, 0},
       {kStopSubprotocol, kOnSocket, 0, kReceiveBytes, 0, nullptr, 0},
       {kFoxgloveSubprotocols[0], kOnSocket, 0, kReceiveBytes, 0, nullptr, 0},
       {kFoxgloveSubprotocols[1], kOnSocket, 0, kReceiveBytes, 0, nullptr, 0},
       {nullptr, nullptr, 0, 0, 0, nullptr, 0}}};
  lws_set_log_level(LLL_ERR, [](int, const char* line) { last_error() = line; });
  last_error().clear();
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN_SERVER;
  info.user = this;
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_DISABLE_IPV6;
  info.fd_limit_per_thread = kMaxDescriptors;
  info.max_http_header_data = kHttpHeaderBytes;
  info.max_http_header_pool = kHeaderPool;
  info.timeout_secs = settings_.patience.request_s;
  info.pt_serv_buf_size = kReceiveBytes;
  info.retry_and_idle_policy = &idle_policy_;
  context_ = lws_create_context(&info);
  if (context_ == nullptr)
    return failure(ErrorCode::kIo, "libwebsockets could not be started: %s", last_error().c_str());
  info.port = settings_.port;
  info.iface = settings_.address.c_str();
  info.protocols = protocols.data();
  info.headers = safety_headers();
  info.keepalive_timeout = kKeepAliveS;
  info.server_string = "touchline";
  info.vhost_name = "touchline";
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_DISABLE_IPV6;
  host_ = lws_create_vhost(context_, &info);
  if (host_ == nullptr && is_port_busy(settings_.address, settings_.port)) {
    return failure(ErrorCode::kDeviceBusy, "%s:%d is used by another program; name another port: --console %s:%d",
                   settings_.address.c_str(), int{settings_.port}, settings_.address.c_str(), settings_.port + 1);
  }
  if (host_ == nullptr) {
    return failure(ErrorCode::kIo,
                   "%s:%d cannot be used: the address is not one of this computer's, or the service may not use the "
                   "network (docs/deploy.md)",
                   settings_.address.c_str(), int{settings_.port});
  }
  schedule(Duration::zero());
  return {};
}

std::uint16_t WebServer::Implementation::port() const {
  return static_cast<std::uint16_t>(lws_get_vhost_listen_port(host_));
}

void WebServer::Implementation::schedule(Duration in) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(in).count();
  lws_sul_schedule(
      context_, 0, &timer_.list,
      [](lws_sorted_usec_list_t* list) {
        Implementation* const owner = reinterpret_cast<Timer*>(list)->owner;
        try {
          owner->tick();
        } catch (const std::exception&) {  // out of memory: the messages of this turn are late
          owner->schedule(kIdlePeriod);
        }
      },
      us + 1);
}

void WebServer::Implementation::tick() {
  const Instant now = hal::MonotonicClock::read();
  measure_links(now);
  hub_.tick(now);
  for (auto& [connection, socket] : sockets_) {
    if (hub_.has_message(*socket.client, now)) ask_to_write(connection);
  }
  bool waits_for_picture = false;
  for (auto& [connection, request] : requests_) {
    if (!is_waiting(request)) continue;
    waits_for_picture = true;
    if (is_ready(request, now)) {
      ask_to_write(connection);
    } else if (!request.is_made) {
      hub_.request_picture(now);
    }
  }
  close_unread(now);
  schedule(hub_.is_watched() || waits_for_picture ? kWatchedPeriod : kIdlePeriod);
}

void WebServer::Implementation::ask_to_write(lws* connection) {
  waiting_.try_emplace(connection, hal::MonotonicClock::read());
  lws_callback_on_writable(connection);
}

void WebServer::Implementation::close_unread(Instant now) {
  std::vector<lws*> unread;
  for (const auto& [connection, since] : waiting_) {
    if (now - since > settings_.patience.unread) unread.push_back(connection);
  }
  for (lws* const connection : unread) {
    waiting_.erase(connection);
    close(connection);
  }
}

void WebServer::Implementation::forget(lws* connection) {
  visitors_.erase(connection);
  waiting_.erase(connection);
  requests_.erase(connection);
  const auto socket = sockets_.find(connection);
  if (socket == sockets_.end()) return;
  if (socket->second.client != nullptr) hub_.disconnect(*socket->second.client);
  sockets_.erase(socket);
}

WebServer::WebServer(Hub& hub, WebServerSettings settings)
    : implementation_(std::make_unique<Implementation>(hub, std::move(settings))) {}
WebServer::~WebServer() = default;
Result<void> WebServer::open() { return implementation_->open(); }
std::uint16_t WebServer::port() const { return implementation_->port(); }
void WebServer::serve() { lws_service(implementation_->context(), 0); }
void WebServer::wake() { lws_cancel_service(implementation_->context()); }

}  // namespace touchline::console
