#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// Checksum and byte order that commands to robots (packet.h) and telemetry (telemetry.h) share.
namespace touchline {

/// CRC-16/CCITT-FALSE (also called CRC-16/IBM-3740): polynomial 0x1021, start value 0xFFFF, no reflection, no final
/// inversion. Check value of the nine characters "123456789": 0x29B1 (catalogue of parametrised CRC algorithms,
/// reveng.sourceforge.io). It detects every error burst of at most 16 bits and every error of up to three bits in a
/// packet of any length that we send.
std::uint16_t crc16_ccitt_false(std::span<const std::byte> bytes);

// Numbers of two bytes are little endian.
constexpr std::byte low_byte(std::uint16_t number) { return static_cast<std::byte>(number & 0xFFu); }
constexpr std::byte high_byte(std::uint16_t number) { return static_cast<std::byte>(number >> 8u); }
/// The number in bytes `at` and `at` + 1, which must exist.
constexpr std::uint16_t uint16_at(std::span<const std::byte> bytes, std::size_t at) {
  const unsigned high = std::to_integer<unsigned>(bytes[at + 1]) << 8u;
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[at]) | high);
}

}  // namespace touchline
