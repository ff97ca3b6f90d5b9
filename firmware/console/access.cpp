#include "firmware/console/access.h"

#include <fcntl.h>
#include <sys/random.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hal/files/input_file.h"

namespace touchline::console {
namespace {

constexpr std::size_t kTokenBytes = 32, kTokenDigits = 2 * kTokenBytes;

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

// Removes the port: "name:8642" gives "name", "[::1]:8642" gives "[::1]".
std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::size_t bracket = host.rfind(']');
  const bool is_port = colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
  return is_port ? host.substr(0, colon) : host;
}

bool consists_of(std::string_view text, std::string_view characters) {
  return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

}  // namespace

bool is_loopback(std::string_view address) {
  constexpr std::string_view kMapped = "::ffff:";
  if (address.starts_with(kMapped)) address.remove_prefix(kMapped.size());
  return address == "::1" || (address.starts_with("127.") && consists_of(address, "0123456789."));
}

bool is_host_permitted(std::string_view host, const std::vector<std::string>& hosts) {
  const std::string_view name = without_port(host);
  // Top-level domains are not numbers, so only addresses consist of digits and points.
  if (consists_of(name, "0123456789.")) return true;
  if (name.starts_with('[') && name.ends_with(']')) {
    return consists_of(name.substr(1, name.size() - 2), "0123456789abcdefABCDEF:.");
  }
  return equal_ignoring_case(name, "localhost") ||
         std::any_of(hosts.begin(), hosts.end(),
                     [&](const std::string& known) { return equal_ignoring_case(name, known); });
}

bool is_origin_permitted(const RequestOrigin& request, bool is_navigation) {
  if (!request.origin.empty()) {
    const std::size_t scheme = request.origin.find("://");
    return scheme != std::string_view::npos && equal_ignoring_case(request.origin.substr(scheme + 3), request.host);
  }
  // Browsers send no Origin for pictures and links.
  return is_navigation || request.fetch_site.empty() || request.fetch_site == "same-origin" ||
         request.fetch_site == "none";
}

bool is_viewer_permitted(std::string_view origin, const std::vector<std::string>& origins) {
  return !origin.empty() && std::find(origins.begin(), origins.end(), origin) != origins.end();
}

bool equal_in_constant_time(std::string_view given, std::string_view expected) {
  unsigned difference = given.size() == expected.size() ? 0 : 1;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const char c = i < given.size() ? given[i] : '\0';
    difference |= static_cast<unsigned>(static_cast<unsigned char>(c) ^ static_cast<unsigned char>(expected[i]));
  }
  // A volatile read prevents the compiler from leaving the loop early.
  const volatile unsigned result = difference;
  return result == 0;
}

std::string_view token_of_cookie(std::string_view cookie) {
  while (!cookie.empty()) {
    const std::size_t end = std::min(cookie.find(';'), cookie.size());
    std::string_view part = cookie.substr(0, end);
    cookie.remove_prefix(std::min(end + 1, cookie.size()));
    part.remove_prefix(std::min(part.find_first_not_of(' '), part.size()));
    const std::size_t equals = part.find('=');
    if (equals != std::string_view::npos && part.substr(0, equals) == kTokenCookie) return part.substr(equals + 1);
  }
  return {};
}

bool is_token(std::string_view given, const AccessRules& rules) {
  return !rules.token.empty() && equal_in_constant_time(given, rules.token);
}

bool has_access(const RequestOrigin& request, const AccessRules& rules) {
  return is_loopback(request.peer) || is_token(token_of_cookie(request.cookie), rules);
}

Result<std::string> read_token(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(std::string text, hal::read_file(path, hal::kMaxTextFileBytes));
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  if (text.size() != kTokenDigits || !consists_of(text, "0123456789abcdef")) {
    return failure(ErrorCode::kCorruptFrame,
                   "%s: contains no token; remove the file and run `touchline console --token`", path.c_str());
  }
  return text;
}

Result<std::string> make_token(const std::string& path) {
  std::error_code ignored;  // open() below reports an error
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0 && errno == EEXIST) return read_token(path);
  if (file < 0) return failure(ErrorCode::kIo, "%s: %s", path.c_str(), std::strerror(errno));
  std::array<unsigned char, kTokenBytes> random{};
  std::string text;
  if (::getrandom(random.data(), random.size(), 0) == static_cast<ssize_t>(random.size())) {
    for (const unsigned char byte : random) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      text += kDigits[byte / 16];
      text += kDigits[byte % 16];
    }
  }
  const std::string line = text + "\n";
  const bool is_written = !text.empty() && ::write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  const bool is_closed = ::close(file) == 0;
  if (is_written && is_closed) return text;
  ::unlink(path.c_str());
  return failure(ErrorCode::kIo, "%s: could not be written", path.c_str());
}

}  // namespace touchline::console
