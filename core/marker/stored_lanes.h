#pragma once

#include <array>
#include <cstdint>

namespace touchline {

constexpr int kLanes = 8;

/// What core/marker/lanes.h computes with, in memory.
struct alignas(32) StoredLanes {
  std::array<float, kLanes> value;
};
struct alignas(32) StoredIntegers {
  std::array<std::int32_t, kLanes> value;
};

}  // namespace touchline
