#include "firmware/report/base64.h"

#include <algorithm>
#include <cstdint>

namespace touchline::report {
namespace {

constexpr std::string_view kBase64Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string base64_of(std::span<const std::byte> bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    const std::size_t digits = std::min<std::size_t>(3, bytes.size() - i) + 1;
    for (std::size_t k = 0; k < digits; ++k) text[i / 3 * 4 + k] = kBase64Digits[three >> (18 - 6 * k) & 63U];
  }
  return text;
}

std::optional<std::string> bytes_of_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t three = 0;
    std::size_t padding = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t digit = kBase64Digits.find(text[i + k]);
      const bool pads = text[i + k] == '=' && i + 4 == text.size() && k >= 2;
      if (digit == std::string_view::npos ? !pads : padding > 0) return std::nullopt;
      padding += pads ? 1 : 0;
      three = three << 6 | (pads ? 0U : static_cast<std::uint32_t>(digit));
    }
    for (std::size_t k = 0; k + padding < 3; ++k) bytes += static_cast<char>(three >> (16 - 8 * k) & 0xffU);
  }
  return bytes;
}

}  // namespace touchline::report
