#pragma once

#include <cmath>

namespace touchline {

/// Above zero, and a number: neither infinite nor NaN.
template <class Float>
[[nodiscard]] bool positive(Float value) {
  return std::isfinite(value) && value > Float{0};
}

}  // namespace touchline
