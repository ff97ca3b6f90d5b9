#pragma once

#include <cstdint>
#include <cstring>

namespace touchline {

/// Reads eight bytes of any alignment as a machine word.
inline std::uint64_t load_word(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

}  // namespace touchline
