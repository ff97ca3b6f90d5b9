#include <array>

#include "firmware/console/web_server_parts.h"

namespace touchline::console {
namespace {

std::string peer_of(lws* connection) {
  std::array<char, 64> text{};
  lws_get_peer_simple(connection, text.data(), text.size());
  return text.data();
}

std::string fetch_site_of(lws* connection) {
  constexpr std::string_view kName = "sec-fetch-site:";
  std::array<char, 32> text{};
  const int size = lws_hdr_custom_copy(connection, text.data(), static_cast<int>(text.size()), kName.data(),
                                       static_cast<int>(kName.size()));
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

// Returns the token of "?token=..." in the address; "" if there is none.
std::string token_argument_of(lws* connection) {
  std::array<char, 256> text{};
  const char* const token = lws_get_urlarg_by_name(connection, "token=", text.data(), static_cast<int>(text.size()));
  return token != nullptr ? std::string(token) : std::string();
}

}  // namespace

std::optional<WebServer::Implementation::Refusal> WebServer::Implementation::check(lws* connection,
                                                                                   Purpose purpose) const {
  const std::string host = header_of(connection, WSI_TOKEN_HOST), origin = header_of(connection, WSI_TOKEN_ORIGIN),
                    cookie = header_of(connection, WSI_TOKEN_HTTP_COOKIE), site = fetch_site_of(connection),
                    peer = peer_of(connection);
  // If an Origin was not copied because it is too long, it must not count as absent.
  const bool has_unread_origin = origin.empty() && lws_hdr_total_length(connection, WSI_TOKEN_ORIGIN) > 0;
  const RequestOrigin request{host, origin, site, cookie, peer};
  if (!is_host_permitted(host, settings_.access.hosts)) {
    return Refusal{HTTP_STATUS_FORBIDDEN,
                   "This name of the computer is not known. Use its address in numbers, or add the name to "
                   "console.hosts in board.toml.\n"};
  }
  // Foxglove's page has another origin; this is permitted, because its protocol can only watch.
  const bool is_viewer = purpose == Purpose::kFoxglove && is_viewer_permitted(origin, settings_.access.origins);
  if (has_unread_origin || !(is_viewer || is_origin_permitted(request, purpose == Purpose::kNavigation))) {
    return Refusal{HTTP_STATUS_FORBIDDEN, "Requests from other sites are refused.\n"};
  }
  // Foxglove cannot have our cookie, so its token is in the address.
  const bool has_token = purpose == Purpose::kFoxglove && is_token(token_argument_of(connection), settings_.access);
  if (!has_token && !has_access(request, settings_.access)) {
    return Refusal{HTTP_STATUS_UNAUTHORIZED,
                   "This computer needs the token. On the board, `touchline console --token` shows it; then open "
                   "/login?token=TOKEN here.\n"};
  }
  return std::nullopt;
}

bool WebServer::Implementation::has_token(lws* connection, Purpose purpose) const {
  const std::string cookie = header_of(connection, WSI_TOKEN_HTTP_COOKIE);
  return is_token(token_of_cookie(cookie), settings_.access) ||
         (purpose == Purpose::kFoxglove && is_token(token_argument_of(connection), settings_.access));
}

int WebServer::Implementation::login(lws* connection) {
  if (!is_token(token_argument_of(connection), settings_.access)) {
    return answer(connection, HTTP_STATUS_FORBIDDEN, "text/plain; charset=utf-8", "The token is wrong.\n");
  }
  const std::string cookie = std::string(kTokenCookie) + "=" + settings_.access.token +
                             "; Path=/; Max-Age=31536000; HttpOnly; SameSite=Strict";
  // The answer is a page instead of a redirect, which would not carry the cookie if a link on another site led here.
  constexpr std::string_view kPage =
      R"(<!doctype html><html lang="en"><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=/"><a href="/">Console</a></html>)";
  return answer(connection, HTTP_STATUS_OK, "text/html; charset=utf-8", kPage,
                {.name = "set-cookie:", .value = cookie});
}

}  // namespace touchline::console
