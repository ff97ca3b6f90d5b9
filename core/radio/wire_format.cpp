#include "core/radio/wire_format.h"

namespace touchline {

std::uint16_t crc16_ccitt_false(std::span<const std::byte> bytes) {
  // Computed bit by bit: 63 bytes take only 504 steps per frame, and robots can copy this code without a table.
  constexpr unsigned kPolynomial = 0x1021u;
  unsigned crc = 0xFFFFu;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<unsigned>(byte) << 8u;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000u) != 0u ? (crc << 1u) ^ kPolynomial : crc << 1u;
      crc &= 0xFFFFu;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace touchline
