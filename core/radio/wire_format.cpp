#include "core/radio/wire_format.h"

namespace touchline {

std::uint16_t crc16_ccitt_false(std::span<const std::byte> bytes) {
  // Bit by bit: 63 bytes are 504 steps a frame, and robots can copy it without a table.
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
