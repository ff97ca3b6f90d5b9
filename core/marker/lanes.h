#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/marker/stored_lanes.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

// Eight floats that are computed at once. What is written with them is compiled twice on x86, in namespaces of their
// own: for every processor, and between avx2_begin.h and avx2_end.h for those with AVX2. Both take the same operations
// in the same order, so that they give the same bits.
#if defined(TOUCHLINE_LANES_OF_AVX2)
#define TOUCHLINE_LANES avx2_lanes
#else
#define TOUCHLINE_LANES portable_lanes
#endif

// For loops over channels and the like: what they index is to be in registers, and gcc 12 leaves loops as they are at
// -O2.
#define TOUCHLINE_UNROLL _Pragma("GCC unroll 4")

namespace touchline {
inline namespace TOUCHLINE_LANES {

#if defined(TOUCHLINE_LANES_OF_AVX2)

using Lanes [[gnu::vector_size(32)]] = float;
using LaneIntegers [[gnu::vector_size(32)]] = std::int32_t;

inline Lanes all_lanes(float value) { return Lanes{value, value, value, value, value, value, value, value}; }
inline LaneIntegers all_integers(std::int32_t v) { return LaneIntegers{v, v, v, v, v, v, v, v}; }
inline Lanes smaller(Lanes a, Lanes b) { return _mm256_min_ps(a, b); }
inline Lanes larger(Lanes a, Lanes b) { return _mm256_max_ps(a, b); }
inline Lanes root(Lanes square) { return _mm256_sqrt_ps(square); }
inline bool any(LaneIntegers mask) { return _mm256_movemask_ps(__builtin_bit_cast(Lanes, mask)) != 0; }
inline Lanes to_floats(LaneIntegers value) { return __builtin_convertvector(value, Lanes); }
inline LaneIntegers to_integers(Lanes value) { return __builtin_convertvector(value, LaneIntegers); }
inline Lanes floats_of_bits(LaneIntegers bits) { return __builtin_bit_cast(Lanes, bits); }
inline LaneIntegers bits_of(Lanes value) { return __builtin_bit_cast(LaneIntegers, value); }
inline std::array<float, 4> sum_of_halves(Lanes v) { return {v[0] + v[4], v[1] + v[5], v[2] + v[6], v[3] + v[7]}; }

#else

// Compilers have registers for four on every board.
using HalfLanes [[gnu::vector_size(16)]] = float;
using HalfIntegers [[gnu::vector_size(16)]] = std::int32_t;

struct LaneIntegers {
  HalfIntegers low, high;

  friend LaneIntegers operator&(LaneIntegers a, LaneIntegers b) { return {a.low & b.low, a.high & b.high}; }
  friend LaneIntegers operator|(LaneIntegers a, LaneIntegers b) { return {a.low | b.low, a.high | b.high}; }
  friend LaneIntegers operator^(LaneIntegers a, LaneIntegers b) { return {a.low ^ b.low, a.high ^ b.high}; }
  friend LaneIntegers operator~(LaneIntegers a) { return {~a.low, ~a.high}; }
  friend LaneIntegers operator+(LaneIntegers a, LaneIntegers b) { return {a.low + b.low, a.high + b.high}; }
  friend LaneIntegers operator*(LaneIntegers a, LaneIntegers b) { return {a.low * b.low, a.high * b.high}; }
  friend LaneIntegers operator<(LaneIntegers a, LaneIntegers b) { return {a.low < b.low, a.high < b.high}; }
};

struct Lanes {
  HalfLanes low, high;

  friend Lanes operator+(Lanes a, Lanes b) { return {a.low + b.low, a.high + b.high}; }
  friend Lanes operator-(Lanes a, Lanes b) { return {a.low - b.low, a.high - b.high}; }
  friend Lanes operator*(Lanes a, Lanes b) { return {a.low * b.low, a.high * b.high}; }
  friend Lanes operator/(Lanes a, Lanes b) { return {a.low / b.low, a.high / b.high}; }
  friend Lanes& operator+=(Lanes& a, Lanes b) { return a = a + b; }
  friend Lanes& operator-=(Lanes& a, Lanes b) { return a = a - b; }
  friend LaneIntegers operator<(Lanes a, Lanes b) { return {a.low < b.low, a.high < b.high}; }
  friend LaneIntegers operator>(Lanes a, Lanes b) { return {a.low > b.low, a.high > b.high}; }
  friend LaneIntegers operator>=(Lanes a, Lanes b) { return {a.low >= b.low, a.high >= b.high}; }
  friend LaneIntegers operator==(Lanes a, Lanes b) { return {a.low == b.low, a.high == b.high}; }
};

inline Lanes all_lanes(float value) {
  const HalfLanes half{value, value, value, value};
  return {half, half};
}
inline LaneIntegers all_integers(std::int32_t value) {
  const HalfIntegers half{value, value, value, value};
  return {half, half};
}
#if defined(__SSE2__)
// gcc 12 makes four instructions each of the expressions below.
inline Lanes smaller(Lanes a, Lanes b) { return {_mm_min_ps(a.low, b.low), _mm_min_ps(a.high, b.high)}; }
inline Lanes larger(Lanes a, Lanes b) { return {_mm_max_ps(a.low, b.low), _mm_max_ps(a.high, b.high)}; }
inline Lanes root(Lanes square) { return {_mm_sqrt_ps(square.low), _mm_sqrt_ps(square.high)}; }
inline bool any(LaneIntegers mask) { return _mm_movemask_ps(__builtin_bit_cast(HalfLanes, mask.low | mask.high)) != 0; }
#else
inline Lanes smaller(Lanes a, Lanes b) { return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high}; }
inline Lanes larger(Lanes a, Lanes b) { return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high}; }
inline Lanes root(Lanes square) {
  for (int i = 0; i < kLanes / 2; ++i) {
    square.low[i] = std::sqrt(square.low[i]);
    square.high[i] = std::sqrt(square.high[i]);
  }
  return square;
}
inline bool any(LaneIntegers mask) {
  const auto bits = __builtin_bit_cast(std::array<std::uint64_t, 2>, mask.low | mask.high);
  return (bits[0] | bits[1]) != 0;
}
#endif
inline Lanes to_floats(LaneIntegers value) {
  return {__builtin_convertvector(value.low, HalfLanes), __builtin_convertvector(value.high, HalfLanes)};
}
inline LaneIntegers to_integers(Lanes value) {
  return {__builtin_convertvector(value.low, HalfIntegers), __builtin_convertvector(value.high, HalfIntegers)};
}
inline Lanes floats_of_bits(LaneIntegers bits) { return __builtin_bit_cast(Lanes, bits); }
inline LaneIntegers bits_of(Lanes value) { return __builtin_bit_cast(LaneIntegers, value); }
inline std::array<float, 4> sum_of_halves(Lanes v) { return __builtin_bit_cast(std::array<float, 4>, v.low + v.high); }

#endif

inline Lanes load(const StoredLanes& from) {
  Lanes lanes;
  std::memcpy(&lanes, from.value.data(), sizeof lanes);
  return lanes;
}
inline LaneIntegers load(const StoredIntegers& from) {
  LaneIntegers lanes;
  std::memcpy(&lanes, from.value.data(), sizeof lanes);
  return lanes;
}
inline void store(Lanes lanes, StoredLanes& to) { std::memcpy(to.value.data(), &lanes, sizeof lanes); }
inline void store(LaneIntegers lanes, StoredIntegers& to) { std::memcpy(to.value.data(), &lanes, sizeof lanes); }

/// 0, 1, 2 ... 7.
inline LaneIntegers counting() { return load(StoredIntegers{{0, 1, 2, 3, 4, 5, 6, 7}}); }
/// Of values that an int holds.
inline LaneIntegers rounded_down(Lanes value) {
  const LaneIntegers towards_0 = to_integers(value);
  return towards_0 + (value < to_floats(towards_0));  // a mask is -1
}
inline LaneIntegers rounded_up(Lanes value) {
  const LaneIntegers towards_0 = to_integers(value);
  return towards_0 + (all_integers(1) & (value > to_floats(towards_0)));
}
inline Lanes between(float low, Lanes value, float high) {
  return smaller(larger(value, all_lanes(low)), all_lanes(high));
}
inline Lanes between_0_and_1(Lanes value) { return smaller(larger(value, all_lanes(0.0f)), all_lanes(1.0f)); }

// A comparison gives masks: all bits of a lane, or none.
inline Lanes keep(LaneIntegers mask, Lanes value) { return floats_of_bits(mask & bits_of(value)); }
inline Lanes choose(LaneIntegers mask, Lanes yes, Lanes no) {
  return floats_of_bits((mask & bits_of(yes)) | (~mask & bits_of(no)));
}
inline LaneIntegers sign_of(Lanes value) { return bits_of(value) & bits_of(all_lanes(-0.0f)); }
inline Lanes absolute(Lanes value) { return floats_of_bits(bits_of(value) ^ sign_of(value)); }
/// `size` is not negative.
inline Lanes with_sign(Lanes size, LaneIntegers sign) { return floats_of_bits(bits_of(size) | sign); }

inline float sum_of(Lanes value) {
  const std::array<float, 4> four = sum_of_halves(value);
  return (four[0] + four[1]) + (four[2] + four[3]);
}
/// How many lanes of a mask are set.
inline int count_of(LaneIntegers mask) { return static_cast<int>(sum_of(keep(mask, all_lanes(1.0f)))); }

}  // namespace TOUCHLINE_LANES
}  // namespace touchline
