#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hal/result.h"

// Decides who may use the console. The page can stop and drive robots, so other web sites and other computers must not
// reach it without permission.
namespace touchline::console {

/// Headers by which a browser describes the origin of a request. A member is empty if the browser did not send the
/// header.
struct RequestOrigin {
  std::string_view host;        // header Host: the host in the browser's address line
  std::string_view origin;      // header Origin: the site whose page sent the request
  std::string_view fetch_site;  // header Sec-Fetch-Site
  std::string_view cookie;      // header Cookie
  std::string_view peer;        // address of the other side of the connection
};

struct AccessRules {
  std::vector<std::string> hosts;      // permitted names in addition to localhost and addresses in numbers
  std::string token;                   // token that clients on other computers need; empty: such clients are rejected
  std::vector<std::string> origins{};  // origins of other programs' pages that may watch with Foxglove's protocol
};

inline constexpr std::string_view kTokenCookie = "touchline_token";

/// Returns whether the address, such as 127.0.0.1 or ::1, belongs to this computer's loopback.
bool is_loopback(std::string_view address);

/// Returns whether a browser may have sent this request on behalf of this console's page. A name that is not listed may
/// belong to a site that made the name point to this computer (DNS rebinding); this is impossible for an address in
/// numbers.
bool is_host_permitted(std::string_view host, const std::vector<std::string>& hosts);
/// Returns whether the request comes from the console's own page, or from no page at all. `is_navigation`: a request
/// for the page itself, to which other sites may link.
bool is_origin_permitted(const RequestOrigin& request, bool is_navigation);
/// Returns whether a page of this origin may watch, although it is not the console's page.
bool is_viewer_permitted(std::string_view origin, const std::vector<std::string>& origins);
/// Returns whether the two texts are equal. Takes the same time for all texts of the length of `expected`.
bool equal_in_constant_time(std::string_view given, std::string_view expected);
/// Returns the token in a Cookie header; "" if there is none.
std::string_view token_of_cookie(std::string_view cookie);
/// Returns whether this is the token.
bool is_token(std::string_view given, const AccessRules& rules);
/// Returns whether the client is on this computer or has the token.
bool has_access(const RequestOrigin& request, const AccessRules& rules);

/// Reads the token in the file, 64 hexadecimal digits. kNotFound: there is no file; kCorruptFrame: it contains no
/// token.
Result<std::string> read_token(const std::string& path);
/// Reads the token in the file; if the file does not exist, makes it, readable only by its owner. Errors of
/// read_token() and of writing.
Result<std::string> make_token(const std::string& path);

}  // namespace touchline::console
