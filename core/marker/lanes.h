#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

// Four floats that are computed at once. Compilers have registers for them on every board, and sums of lanes are taken
// in one order, whatever registers there are.
namespace touchline {

using Lanes [[gnu::vector_size(16)]] = float;
using LaneMask [[gnu::vector_size(16)]] = std::int32_t;  // of a comparison: all bits of a lane, or none
constexpr int kLanes = 4;

inline Lanes all_lanes(float value) { return Lanes{value, value, value, value}; }
/// 0, step, 2 step, 3 step.
inline Lanes rising(float step) { return Lanes{0.0f, step, 2.0f * step, 3.0f * step}; }

#if defined(__SSE2__)
// gcc 12 makes four instructions each of the expressions below.
inline Lanes smaller(Lanes a, Lanes b) { return _mm_min_ps(a, b); }
inline Lanes larger(Lanes a, Lanes b) { return _mm_max_ps(a, b); }
inline Lanes root(Lanes square) { return _mm_sqrt_ps(square); }
inline bool any(LaneMask mask) { return _mm_movemask_ps(std::bit_cast<Lanes>(mask)) != 0; }
#else
inline Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes root(Lanes square) {
  for (int i = 0; i < kLanes; ++i) square[i] = std::sqrt(square[i]);
  return square;
}
inline bool any(LaneMask mask) {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2> >(mask);
  return (halves[0] | halves[1]) != 0;
}
#endif
inline Lanes between_0_and_1(Lanes value) { return smaller(larger(value, Lanes{}), all_lanes(1.0f)); }

inline Lanes keep(LaneMask mask, Lanes value) { return std::bit_cast<Lanes>(mask & std::bit_cast<LaneMask>(value)); }
inline LaneMask sign_of(Lanes value) {
  return std::bit_cast<LaneMask>(value) & std::bit_cast<LaneMask>(all_lanes(-0.0f));
}
inline Lanes absolute(Lanes value) { return std::bit_cast<Lanes>(std::bit_cast<LaneMask>(value) ^ sign_of(value)); }
/// `size` is not negative.
inline Lanes with_sign(Lanes size, LaneMask sign) { return std::bit_cast<Lanes>(std::bit_cast<LaneMask>(size) | sign); }

inline float sum_of(Lanes value) { return (value[0] + value[1]) + (value[2] + value[3]); }

}  // namespace touchline
