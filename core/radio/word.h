#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// Numbers of two bytes as packets carry them: low byte first.
namespace touchline {

constexpr std::byte low_byte(std::uint16_t word) { return static_cast<std::byte>(word & 0xFFu); }
constexpr std::byte high_byte(std::uint16_t word) { return static_cast<std::byte>(word >> 8u); }
constexpr std::uint16_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  const unsigned high = std::to_integer<unsigned>(bytes[at + 1]) << 8u;
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[at]) | high);
}

}  // namespace touchline
