#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/geometry/vector2.h"

namespace touchline::hal {

/// The hash FNV-1a (Fowler, Noll, Vo; 64 bits) of numbers and bytes, for states that must be equal bit for bit.
class Fnv1a {
 public:
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(Vector2 value) {
    add(value.x);
    add(value.y);
  }
  void add(std::uint64_t value) {
    for (unsigned shift = 0; shift < 64; shift += 8) add_byte(value >> shift & 0xFFU);
  }
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) add_byte(std::to_integer<std::uint64_t>(byte));
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void add_byte(std::uint64_t byte) { hash_ = (hash_ ^ byte) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

}  // namespace touchline::hal
