#include "hal/linux/network/network_address.h"

#include <net/if.h>
#include <sys/un.h>
#include <array>
#include <charconv>
#include <optional>

namespace touchline::hal {
namespace {

constexpr std::string_view kUdp = "udp://", kUnix = "unix://";
constexpr std::string_view kExpected = "expected udp://ADDRESS:PORT, udp://ADDRESS:PORT%INTERFACE or unix:///PATH";

template <class... Parts>
Error wrong(std::string_view text, const Parts&... parts) {
  Error error{ErrorCode::kOutOfRange, {}};
  error.text.append("\"");
  error.text.append(text);
  error.text.append("\": ");
  (error.text.append(parts), ...);
  return error;
}

std::optional<std::uint32_t> number(std::string_view text, std::uint32_t limit) {
  std::uint32_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = code == std::errc() && end == text.data() + text.size() && !text.empty();
  return is_whole && value <= limit ? std::optional(value) : std::nullopt;
}

std::optional<std::uint32_t> ipv4(std::string_view text) {
  if (text == "localhost") return 0x7f000001;
  std::uint32_t address = 0;
  for (int part = 0; part < 4; ++part) {
    const std::size_t dot = text.find('.');
    if ((dot == std::string_view::npos) != (part == 3)) return std::nullopt;
    const std::optional<std::uint32_t> byte = number(text.substr(0, dot), 255);
    if (!byte) return std::nullopt;
    address = address << 8 | *byte;
    text.remove_prefix(part == 3 ? text.size() : dot + 1);
  }
  return address;
}

Result<NetworkAddress> parse_udp(std::string_view text) {
  std::string_view rest = text.substr(kUdp.size());
  NetworkAddress address;
  if (const std::size_t percent = rest.find('%'); percent != std::string_view::npos) {
    address.interface = rest.substr(percent + 1);
    rest = rest.substr(0, percent);
    if (address.interface.empty()) return wrong(text, "the name of the interface after % is missing");
    if (address.interface.size() >= IFNAMSIZ || address.interface.find_first_of("/ :%") != std::string::npos) {
      return wrong(text, "\"", address.interface, "\" cannot be the name of an interface; `ip link` lists them");
    }
  }
  if (rest.starts_with('[')) return wrong(text, "IPv6 is not supported; use an IPv4 address");
  const std::size_t colon = rest.find(':');
  if (colon == std::string_view::npos) return wrong(text, "the port is missing; ", kExpected);
  const std::optional<std::uint32_t> ip = ipv4(rest.substr(0, colon));
  if (!ip) return wrong(text, "\"", rest.substr(0, colon), "\" is not an IPv4 address in numbers");
  const std::optional<std::uint32_t> port = number(rest.substr(colon + 1), 65535);
  if (!port || *port == 0) return wrong(text, "the port \"", rest.substr(colon + 1), "\" is not between 1 and 65535");
  address.ipv4 = *ip;
  address.port = static_cast<std::uint16_t>(*port);
  return address;
}

Result<NetworkAddress> parse_unix(std::string_view text) {
  NetworkAddress address;
  address.kind = NetworkAddress::Kind::kUnix;
  address.path = text.substr(kUnix.size());
  if (!address.path.starts_with('/')) return wrong(text, "the path must be absolute: unix:///PATH");
  if (address.path.ends_with('/')) return wrong(text, "the path names a folder; name a file");
  constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;
  if (address.path.size() > kLongestPath) {
    return wrong(text, "the path is too long: a unix socket has at most ", std::to_string(kLongestPath), " bytes");
  }
  return address;
}

}  // namespace

std::string ipv4_text(std::uint32_t address) {
  return std::to_string(address >> 24) + "." + std::to_string(address >> 16 & 255) + "." +
         std::to_string(address >> 8 & 255) + "." + std::to_string(address & 255);
}

std::string NetworkAddress::text() const {
  if (kind == Kind::kUnix) return std::string(kUnix) + path;
  std::string out = std::string(kUdp) + ipv4_text(ipv4) + ":" + std::to_string(port);
  if (!interface.empty()) out += "%" + interface;
  return out;
}

Result<NetworkAddress> parse_network_address(std::string_view text) {
  if (text.starts_with(kUdp)) return parse_udp(text);
  if (text.starts_with(kUnix)) return parse_unix(text);
  return wrong(text, kExpected);
}

Result<NetworkAddress> parse_udp_destination(std::string_view text, std::uint16_t usual_port) {
  const std::size_t colon = text.find(':');
  const std::optional<std::uint32_t> ip = ipv4(text.substr(0, colon));
  if (!ip) return wrong(text, "expected an IPv4 address in numbers, such as 192.168.1.11:8081");
  if (*ip == 0) return wrong(text, "0.0.0.0 is no destination");
  std::optional<std::uint32_t> port = usual_port;
  if (colon != std::string_view::npos) port = number(text.substr(colon + 1), 65535);
  if (colon == std::string_view::npos && usual_port == 0) {
    return wrong(text, "the port is missing: 192.168.1.11:8081, or radio.port for all robots");
  }
  if (!port || *port == 0) return wrong(text, "the port \"", text.substr(colon + 1), "\" is not between 1 and 65535");
  NetworkAddress address;
  address.ipv4 = *ip;
  address.port = static_cast<std::uint16_t>(*port);
  return address;
}

Result<NetworkRange> parse_network_range(std::string_view text) {
  const std::size_t slash = text.find('/');
  const std::optional<std::uint32_t> ip = ipv4(text.substr(0, slash));
  if (!ip) return wrong(text, "expected an IPv4 address or a network such as 192.168.1.0/24");
  NetworkRange range{*ip, 32};
  if (slash != std::string_view::npos) {
    const std::optional<std::uint32_t> bits = number(text.substr(slash + 1), 32);
    if (!bits) return wrong(text, "the number of bits after / is not between 0 and 32");
    range.prefix_bits = static_cast<int>(*bits);
  }
  return range;
}

}  // namespace touchline::hal
