#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "firmware/console/protocol.h"
#include "firmware/console/web_server_parts.h"

namespace touchline::console {
namespace {

// Limit of the bytes that the kernel keeps for a busy link. More bytes would be outdated when they are sent, and would
// delay answers.
constexpr int kMaxUnsentBytes = 16 * 1024;

// Data of the kernel about a link.
struct Link {
  Duration round_trip{};        // shortest round-trip time
  std::uint64_t confirmed = 0;  // bytes that have arrived at the other computer, whether or not the page has read them
};
Link link_of(lws* connection) {
  tcp_info information{};
  socklen_t size = sizeof(information);
  if (::getsockopt(lws_get_socket_fd(connection), IPPROTO_TCP, TCP_INFO, &information, &size) != 0) return {};
  return {std::chrono::microseconds(information.tcpi_min_rtt), information.tcpi_bytes_acked};
}

// Returns the time at which the last bytes of the connection arrived in the kernel. This thread may have read them
// late, which must not make a message look newer.
Instant arrival_at(lws* connection) {
  // The kernel's figure is an age. If this thread loses the processor between clock and age, the message looks older
  // than it is, so both are read again.
  constexpr int kAttempts = 5;
  constexpr auto kAtOnce = std::chrono::milliseconds(2);
  Instant arrival{};
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Instant now = hal::MonotonicClock::read();
    tcp_info information{};
    socklen_t size = sizeof(information);
    if (::getsockopt(lws_get_socket_fd(connection), IPPROTO_TCP, TCP_INFO, &information, &size) != 0) return now;
    arrival = now - std::chrono::milliseconds(information.tcpi_last_data_recv);
    if (hal::MonotonicClock::read() - now < kAtOnce) break;
  }
  return arrival;
}

// Returns the size of the frame header of a message from the server (RFC 6455, section 5.2).
std::size_t frame_header_bytes(std::size_t size) { return size < 126 ? 2 : size < 65536 ? 4 : 10; }

ClientProtocol protocol_of(lws* connection) {
  const std::string_view name = lws_get_protocol(connection)->name;
  if (name == kStopSubprotocol) return ClientProtocol::kStop;
  return name == kSubprotocol ? ClientProtocol::kTouchline : ClientProtocol::kFoxglove;
}

}  // namespace

int WebServer::Implementation::on_socket(lws* connection, lws_callback_reasons reason, void* in, std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: {
      const bool is_foxglove = protocol_of(connection) == ClientProtocol::kFoxglove;
      if (header_of(connection, WSI_TOKEN_GET_URI) != (is_foxglove ? "/foxglove" : "/ws")) return -1;
      const std::optional<Refusal> refusal = check(connection, is_foxglove ? Purpose::kFoxglove : Purpose::kConsole);
      if (!refusal) return 0;
      lws_return_http_status(connection, refusal->status, refusal->text.c_str());
      return -1;
    }
    case LWS_CALLBACK_ESTABLISHED:
      return accept_socket(connection);
    case LWS_CALLBACK_RECEIVE:
      return receive(connection, {static_cast<const char*>(in), size});
    case LWS_CALLBACK_SERVER_WRITEABLE:
      waiting_.erase(connection);
      return write_socket(connection);
    case LWS_CALLBACK_CLOSED:
    case LWS_CALLBACK_WSI_DESTROY:
      forget(connection);
      return 0;
    default:
      return 0;
  }
}

int WebServer::Implementation::accept_socket(lws* connection) {
  visitors_.erase(connection);
  const ClientProtocol protocol = protocol_of(connection);
  if (protocol == ClientProtocol::kStop) limit_stop_lines();
  const Purpose purpose = protocol == ClientProtocol::kFoxglove ? Purpose::kFoxglove : Purpose::kConsole;
  Client* const client = hub_.connect(hal::MonotonicClock::read(), protocol, has_token(connection, purpose));
  if (client == nullptr) {
    // "Try again later" (RFC 6455, registered as 1013).
    return end_socket(connection, static_cast<lws_close_status>(1013), "too many clients");
  }
  ::setsockopt(lws_get_socket_fd(connection), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kMaxUnsentBytes,
               sizeof(kMaxUnsentBytes));
  int waiting = 0;  // number of bytes of the handshake's answer that wait
  ::ioctl(lws_get_socket_fd(connection), SIOCOUTQ, &waiting);
  const std::uint64_t confirmed = link_of(connection).confirmed + static_cast<std::uint64_t>(waiting);
  sockets_[connection] = {client, confirmed, {}};
  schedule(Duration::zero());
  return 0;
}

int WebServer::Implementation::end_socket(lws* connection, lws_close_status status, std::string_view reason) {
  std::array<unsigned char, 64> text{};
  const std::size_t size = std::min(reason.size(), text.size());
  std::copy_n(reason.begin(), size, text.begin());
  lws_close_reason(connection, status, text.data(), size);
  return -1;
}

int WebServer::Implementation::receive(lws* connection, std::string_view part) {
  const auto found = sockets_.find(connection);
  if (found == sockets_.end()) return -1;
  Socket& socket = found->second;
  if (lws_frame_is_binary(connection) != 0) {
    return end_socket(connection, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "only texts are understood");
  }
  if (socket.received.size() + part.size() > hub_.max_message_bytes(*socket.client)) {
    return end_socket(connection, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "the message is too large");
  }
  socket.received.append(part);
  if (lws_remaining_packet_payload(connection) > 0 || lws_is_final_fragment(connection) == 0) return 0;
  const std::string text = std::move(socket.received);
  socket.received.clear();
  const Instant now = hal::MonotonicClock::read();
  if (!hub_.receive(*socket.client, text, arrival_at(connection), now)) {
    return end_socket(connection, LWS_CLOSE_STATUS_POLICY_VIOLATION, "too many messages");
  }
  // Send at once the answer to the message, and the changes that other clients must learn.
  schedule(Duration::zero());
  return 0;
}

void WebServer::Implementation::measure_links(Instant now) {
  for (const auto& [connection, socket] : sockets_) {
    if (!socket.client->link.is_measuring()) continue;
    const Link link = link_of(connection);
    socket.client->link.delivered(link.confirmed - std::min(link.confirmed, socket.confirmed_before), now,
                                  link.round_trip);
  }
}

int WebServer::Implementation::write_socket(lws* connection) {
  const auto found = sockets_.find(connection);
  if (found == sockets_.end()) return 0;
  Client& client = *found->second.client;
  const Instant now = hal::MonotonicClock::read();
  const Outgoing message = hub_.next_message(client, now);
  if (!message.bytes.empty()) {
    auto* const bytes = reinterpret_cast<unsigned char*>(message.bytes.data());
    client.written += message.bytes.size() + frame_header_bytes(message.bytes.size());
    if (lws_write(connection, bytes, message.bytes.size(), message.is_binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < 0) {
      return -1;
    }
  }
  if (hub_.has_message(client, now)) ask_to_write(connection);
  return 0;
}

}  // namespace touchline::console
