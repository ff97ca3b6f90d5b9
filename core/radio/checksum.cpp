#include "core/radio/checksum.h"

namespace touchline {
namespace {

// Parameters of a CRC: both the bytes and the result are reflected, or neither.
struct Crc {
  unsigned width = 16, polynomial = 0, start = 0;
  bool reflected = false;
  unsigned inversion = 0;
};

unsigned reflect(unsigned value, unsigned width) {
  unsigned out = 0;
  for (unsigned bit = 0; bit < width; ++bit) out |= ((value >> bit) & 1u) << (width - 1u - bit);
  return out;
}

// Computed bit by bit: a packet takes some hundred steps per frame, and robots can copy this code without a table.
std::uint16_t crc(const Crc& of, std::span<const std::byte> bytes) {
  const unsigned top = 1u << (of.width - 1u), mask = (top << 1u) - 1u;
  unsigned value = of.start;
  for (const std::byte byte : bytes) {
    const auto number = std::to_integer<unsigned>(byte);
    value ^= (of.reflected ? reflect(number, 8) : number) << (of.width - 8u);
    for (int bit = 0; bit < 8; ++bit) {
      value = ((value & top) != 0u ? (value << 1u) ^ of.polynomial : value << 1u) & mask;
    }
  }
  if (of.reflected) value = reflect(value, of.width);
  return static_cast<std::uint16_t>(value ^ of.inversion);
}

unsigned sum(std::span<const std::byte> bytes) {
  unsigned out = 0;
  for (const std::byte byte : bytes) out += std::to_integer<unsigned>(byte);
  return out;
}

}  // namespace

std::size_t check_bytes(CheckKind kind) {
  switch (kind) {
    case CheckKind::kSum8:
    case CheckKind::kSum8Complement:
    case CheckKind::kXor8:
    case CheckKind::kCrc8:
    case CheckKind::kCrc8Maxim:
      return 1;
    default:
      return 2;
  }
}

std::uint16_t checksum(CheckKind kind, std::span<const std::byte> bytes) {
  switch (kind) {
    case CheckKind::kSum8:
      return static_cast<std::uint16_t>(sum(bytes) & 0xFFu);
    case CheckKind::kSum8Complement:
      return static_cast<std::uint16_t>(0xFFu - (sum(bytes) & 0xFFu));
    case CheckKind::kXor8: {
      std::byte out{0};
      for (const std::byte byte : bytes) out ^= byte;
      return std::to_integer<std::uint16_t>(out);
    }
    case CheckKind::kSum16:
      return static_cast<std::uint16_t>(sum(bytes));
    case CheckKind::kWordSum16: {
      unsigned out = 0;
      for (std::size_t i = 0; i < bytes.size(); ++i) out += std::to_integer<unsigned>(bytes[i]) << (i % 2 * 8);
      return static_cast<std::uint16_t>(out);
    }
    case CheckKind::kCrc8:
      return crc({8, 0x07u, 0u, false, 0u}, bytes);
    case CheckKind::kCrc8Maxim:
      return crc({8, 0x31u, 0u, true, 0u}, bytes);
    case CheckKind::kCrc16Ccitt:
      return crc({16, 0x1021u, 0xFFFFu, false, 0u}, bytes);
    case CheckKind::kCrc16Xmodem:
      return crc({16, 0x1021u, 0u, false, 0u}, bytes);
    case CheckKind::kCrc16Kermit:
      return crc({16, 0x1021u, 0u, true, 0u}, bytes);
    case CheckKind::kCrc16X25:
      return crc({16, 0x1021u, 0xFFFFu, true, 0xFFFFu}, bytes);
    case CheckKind::kCrc16Modbus:
      return crc({16, 0x8005u, 0xFFFFu, true, 0u}, bytes);
    case CheckKind::kCrc16Arc:
      return crc({16, 0x8005u, 0u, true, 0u}, bytes);
  }
  return 0;
}

}  // namespace touchline
