#include <algorithm>
#include <charconv>

#include "firmware/config/resolve_radio.h"

namespace touchline::config {

std::optional<std::uint64_t> radio_address(std::string_view text) {
  if (text.empty()) return std::nullopt;
  const auto number = [](std::string_view part, int base) -> std::optional<std::uint64_t> {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value, base);
    if (error != std::errc() || end != part.data() + part.size()) return std::nullopt;
    return value;
  };
  const auto parts = [&](char separator, int base, std::size_t count) -> std::optional<std::uint64_t> {
    std::uint64_t value = 0;
    std::string_view rest = text;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t end = std::min(rest.find(separator), rest.size());
      const auto part = number(rest.substr(0, end), base);
      if (!part || *part > 255 || (end == rest.size()) != (i + 1 == count)) return std::nullopt;
      value = value * 256 + *part;
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return value;
  };
  const auto colons = std::count(text.begin(), text.end(), ':');
  if (colons == 5 || colons == 7) return parts(':', 16, static_cast<std::size_t>(colons + 1));
  if (text.find('.') != std::string_view::npos) {
    text = text.substr(0, text.find(':'));
    return parts('.', 10, 4);
  }
  if (text.starts_with("0x") || text.starts_with("0X")) return number(text.substr(2), 16);
  return number(text, 10);
}

}  // namespace touchline::config
