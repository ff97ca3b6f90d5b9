#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/parameter.h"

namespace touchline {

/// Checksums of packets. The names of CRCs and their parameters are those of the catalogue of parametrised CRC
/// algorithms (reveng.sourceforge.io).
enum class CheckKind : std::uint8_t {
  kSum8,            // sum of the bytes modulo 256
  kSum8Complement,  // 255 - sum: XBee's API frames
  kXor8,
  kSum16,       // sum of the bytes modulo 65536
  kWordSum16,   // sum of little-endian words of two bytes modulo 65536
  kCrc8,        // CRC-8/SMBUS
  kCrc8Maxim,   // CRC-8/MAXIM-DOW
  kCrc16Ccitt,  // CRC-16/IBM-3740, often called CCITT-FALSE
  kCrc16Xmodem,
  kCrc16Kermit,
  kCrc16X25,  // CRC-16/IBM-SDLC
  kCrc16Modbus,
  kCrc16Arc
};
inline constexpr std::array<Choice<CheckKind>, 13> kCheckKinds{{{"sum8", CheckKind::kSum8},
                                                                {"sum8-complement", CheckKind::kSum8Complement},
                                                                {"xor8", CheckKind::kXor8},
                                                                {"sum16", CheckKind::kSum16},
                                                                {"word-sum16", CheckKind::kWordSum16},
                                                                {"crc8", CheckKind::kCrc8},
                                                                {"crc8-maxim", CheckKind::kCrc8Maxim},
                                                                {"crc16-ccitt-false", CheckKind::kCrc16Ccitt},
                                                                {"crc16-xmodem", CheckKind::kCrc16Xmodem},
                                                                {"crc16-kermit", CheckKind::kCrc16Kermit},
                                                                {"crc16-x25", CheckKind::kCrc16X25},
                                                                {"crc16-modbus", CheckKind::kCrc16Modbus},
                                                                {"crc16-arc", CheckKind::kCrc16Arc}}};

/// Number of bytes of the result, 1 or 2.
std::size_t check_bytes(CheckKind kind);
/// Checksum of `bytes`.
std::uint16_t checksum(CheckKind kind, std::span<const std::byte> bytes);

}  // namespace touchline
