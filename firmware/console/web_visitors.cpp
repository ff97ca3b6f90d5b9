#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <tuple>

#include "firmware/console/web_server_parts.h"

// Decides which connections are kept when places are short. Anyone can open connections without a request at no cost,
// so these must not keep out a new page or a Stop.
namespace touchline::console {
namespace {

// Enough for ten pages that are loaded at the same moment, with the six connections that browsers open for each.
constexpr std::ptrdiff_t kMaxVisitors = 60;

}  // namespace

void WebServer::Implementation::admit(lws* connection) {
  std::array<char, 64> address{};
  lws_get_peer_simple(connection, address.data(), address.size());
  visitors_[connection] = {address.data(), hal::MonotonicClock::read()};
  limit_visitors();
}

// Streams and bug reports do not count here: they are few, and need access.
bool WebServer::Implementation::is_long_request(lws* connection) const {
  const auto request = requests_.find(connection);
  return request != requests_.end() && request->second.kind != HttpRequest::Kind::kText;
}

void WebServer::Implementation::limit_visitors() {
  const auto counts = [this](const auto& visitor) {
    return !visitor.second.is_closing && !is_long_request(visitor.first);
  };
  if (std::count_if(visitors_.begin(), visitors_.end(), counts) <= kMaxVisitors) return;
  std::map<std::string_view, int> of_address;
  for (const auto& visitor : visitors_) {
    if (counts(visitor)) ++of_address[visitor.second.address];
  }
  // Chooses a visitor of the address with the most visitors: first a visitor without a request, and among these the one
  // that has been silent longest.
  const auto rank = [&](const auto& visitor) {
    const bool waits_for_answer = requests_.contains(visitor.first);
    return std::tuple(counts(visitor), of_address[visitor.second.address], !waits_for_answer,
                      -visitor.second.since.time_since_epoch());
  };
  const auto least = std::max_element(visitors_.begin(), visitors_.end(),
                                      [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  least->second.is_closing = true;
  close(least->first);
}

void WebServer::Implementation::limit_stop_lines() {
  const Client* const silent = hub_.surplus_stop_line();
  const auto socket = std::find_if(sockets_.begin(), sockets_.end(),
                                   [silent](const auto& entry) { return entry.second.client == silent; });
  if (silent == nullptr || socket == sockets_.end()) return;
  lws* const connection = socket->first;
  forget(connection);
  close(connection);
}

void WebServer::Implementation::close(lws* connection) {
  lws_set_timeout(connection, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
}

}  // namespace touchline::console
