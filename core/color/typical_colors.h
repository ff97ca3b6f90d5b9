#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// Mean pixel value of each color's patches after correction by the light map, by color id.
struct TypicalColors {
  std::array<std::array<std::uint8_t, 3>, kMaxColors + 1> value{};
  // False if the value was not measured: the middle of the color's first box, or zero.
  std::array<bool, kMaxColors + 1> measured{};

  std::array<std::uint8_t, 3>& operator[](std::size_t color) { return value[color]; }
  const std::array<std::uint8_t, 3>& operator[](std::size_t color) const { return value[color]; }
};

}  // namespace touchline
