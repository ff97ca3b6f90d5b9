#pragma once

#include <bit>
#include <cstdint>

#include "core/geometry/vector2.h"

namespace touchline::hal::mock {

/// The hash FNV-1a (Fowler, Noll, Vo; 64 bits) of numbers, for states that must be equal bit for bit.
class Fnv1a {
 public:
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(Vector2 value) {
    add(value.x);
    add(value.y);
  }
  void add(std::uint64_t value) {
    for (unsigned shift = 0; shift < 64; shift += 8) hash_ = (hash_ ^ ((value >> shift) & 0xFFU)) * 0x100000001B3U;
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

}  // namespace touchline::hal::mock
