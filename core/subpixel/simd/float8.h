// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

// For short loops, for example over channels: gcc 12 unrolls no loops at -O2, and arrays that such loops index stay in
// memory instead of registers.
#define TOUCHLINE_UNROLL _Pragma("GCC unroll 4")

namespace touchline {
namespace TOUCHLINE_SIMD {

#if defined(TOUCHLINE_SIMD_AVX2)

using Float8 [[gnu::vector_size(32)]] = float;
using Integer8 [[gnu::vector_size(32)]] = std::int32_t;

inline Float8 broadcast(float value) { return Float8{value, value, value, value, value, value, value, value}; }
inline Integer8 broadcast_integer(std::int32_t v) { return Integer8{v, v, v, v, v, v, v, v}; }
inline Float8 min(Float8 a, Float8 b) { return _mm256_min_ps(a, b); }
inline Float8 max(Float8 a, Float8 b) { return _mm256_max_ps(a, b); }
inline Float8 sqrt(Float8 square) { return _mm256_sqrt_ps(square); }
inline bool any(Integer8 mask) { return _mm256_movemask_ps(__builtin_bit_cast(Float8, mask)) != 0; }
inline Float8 to_floats(Integer8 value) { return __builtin_convertvector(value, Float8); }
inline Integer8 to_integers(Float8 value) { return __builtin_convertvector(value, Integer8); }
inline Float8 as_floats(Integer8 bits) { return __builtin_bit_cast(Float8, bits); }
inline Integer8 as_integers(Float8 value) { return __builtin_bit_cast(Integer8, value); }
inline std::array<float, 4> add_halves(Float8 v) { return {v[0] + v[4], v[1] + v[5], v[2] + v[6], v[3] + v[7]}; }

#else

// All supported processors have registers for four floats.
using Float4 [[gnu::vector_size(16)]] = float;
using Integer4 [[gnu::vector_size(16)]] = std::int32_t;

struct Integer8 {
  Integer4 low, high;

  friend Integer8 operator&(Integer8 a, Integer8 b) { return {a.low & b.low, a.high & b.high}; }
  friend Integer8 operator|(Integer8 a, Integer8 b) { return {a.low | b.low, a.high | b.high}; }
  friend Integer8 operator^(Integer8 a, Integer8 b) { return {a.low ^ b.low, a.high ^ b.high}; }
  friend Integer8 operator~(Integer8 a) { return {~a.low, ~a.high}; }
  friend Integer8 operator+(Integer8 a, Integer8 b) { return {a.low + b.low, a.high + b.high}; }
  friend Integer8 operator-(Integer8 a, Integer8 b) { return {a.low - b.low, a.high - b.high}; }
  friend Integer8 operator>>(Integer8 a, std::int32_t bits) { return {a.low >> bits, a.high >> bits}; }
  friend Integer8 operator*(Integer8 a, Integer8 b) { return {a.low * b.low, a.high * b.high}; }
  friend Integer8 operator<(Integer8 a, Integer8 b) { return {a.low < b.low, a.high < b.high}; }
};

struct Float8 {
  Float4 low, high;

  friend Float8 operator+(Float8 a, Float8 b) { return {a.low + b.low, a.high + b.high}; }
  friend Float8 operator-(Float8 a, Float8 b) { return {a.low - b.low, a.high - b.high}; }
  friend Float8 operator*(Float8 a, Float8 b) { return {a.low * b.low, a.high * b.high}; }
  friend Float8 operator/(Float8 a, Float8 b) { return {a.low / b.low, a.high / b.high}; }
  friend Float8& operator+=(Float8& a, Float8 b) { return a = a + b; }
  friend Float8& operator-=(Float8& a, Float8 b) { return a = a - b; }
  friend Integer8 operator<(Float8 a, Float8 b) { return {a.low < b.low, a.high < b.high}; }
  friend Integer8 operator>(Float8 a, Float8 b) { return {a.low > b.low, a.high > b.high}; }
  friend Integer8 operator>=(Float8 a, Float8 b) { return {a.low >= b.low, a.high >= b.high}; }
  friend Integer8 operator==(Float8 a, Float8 b) { return {a.low == b.low, a.high == b.high}; }
};

inline Float8 broadcast(float value) {
  const Float4 half{value, value, value, value};
  return {half, half};
}
inline Integer8 broadcast_integer(std::int32_t value) {
  const Integer4 half{value, value, value, value};
  return {half, half};
}
#if defined(__SSE2__)
// gcc 12 compiles each of the portable expressions below to four instructions.
inline Float8 min(Float8 a, Float8 b) { return {_mm_min_ps(a.low, b.low), _mm_min_ps(a.high, b.high)}; }
inline Float8 max(Float8 a, Float8 b) { return {_mm_max_ps(a.low, b.low), _mm_max_ps(a.high, b.high)}; }
inline Float8 sqrt(Float8 square) { return {_mm_sqrt_ps(square.low), _mm_sqrt_ps(square.high)}; }
inline bool any(Integer8 mask) { return _mm_movemask_ps(__builtin_bit_cast(Float4, mask.low | mask.high)) != 0; }
#else
inline Float8 min(Float8 a, Float8 b) { return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high}; }
inline Float8 max(Float8 a, Float8 b) { return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high}; }
inline Float8 sqrt(Float8 square) {
  for (int i = 0; i < kLanes / 2; ++i) {
    square.low[i] = std::sqrt(square.low[i]);
    square.high[i] = std::sqrt(square.high[i]);
  }
  return square;
}
inline bool any(Integer8 mask) {
  const auto bits = __builtin_bit_cast(std::array<std::uint64_t, 2>, mask.low | mask.high);
  return (bits[0] | bits[1]) != 0;
}
#endif
inline Float8 to_floats(Integer8 value) {
  return {__builtin_convertvector(value.low, Float4), __builtin_convertvector(value.high, Float4)};
}
inline Integer8 to_integers(Float8 value) {
  return {__builtin_convertvector(value.low, Integer4), __builtin_convertvector(value.high, Integer4)};
}
inline Float8 as_floats(Integer8 bits) { return __builtin_bit_cast(Float8, bits); }
inline Integer8 as_integers(Float8 value) { return __builtin_bit_cast(Integer8, value); }
inline std::array<float, 4> add_halves(Float8 v) { return __builtin_bit_cast(std::array<float, 4>, v.low + v.high); }

#endif

inline Float8 load(const StoredFloat8& from) {
  Float8 lanes;
  std::memcpy(&lanes, from.value.data(), sizeof lanes);
  return lanes;
}
inline Integer8 load(const StoredInteger8& from) {
  Integer8 lanes;
  std::memcpy(&lanes, from.value.data(), sizeof lanes);
  return lanes;
}
inline void store(Float8 lanes, StoredFloat8& to) { std::memcpy(to.value.data(), &lanes, sizeof lanes); }
inline void store(Integer8 lanes, StoredInteger8& to) { std::memcpy(to.value.data(), &lanes, sizeof lanes); }

/// 0, 1, 2 ... 7.
inline Integer8 iota() { return load(StoredInteger8{{0, 1, 2, 3, 4, 5, 6, 7}}); }
/// For values in the range of int.
inline Integer8 floor_to_integer(Float8 value) {
  const Integer8 towards_0 = to_integers(value);
  return towards_0 + (value < to_floats(towards_0));  // true is -1
}
inline Integer8 ceil_to_integer(Float8 value) {
  const Integer8 towards_0 = to_integers(value);
  return towards_0 + (broadcast_integer(1) & (value > to_floats(towards_0)));
}
inline Float8 clamp(Float8 value, float low, float high) { return min(max(value, broadcast(low)), broadcast(high)); }
inline Float8 clamp_to_unit(Float8 value) { return min(max(value, broadcast(0.0f)), broadcast(1.0f)); }

// Comparisons return masks: in each lane all bits are set, or none.
inline Float8 select(Integer8 mask, Float8 value) { return as_floats(mask & as_integers(value)); }
inline Float8 select(Integer8 mask, Float8 yes, Float8 no) {
  return as_floats((mask & as_integers(yes)) | (~mask & as_integers(no)));
}
inline Integer8 sign_bit(Float8 value) { return as_integers(value) & as_integers(broadcast(-0.0f)); }
inline Float8 abs(Float8 value) { return as_floats(as_integers(value) ^ sign_bit(value)); }
/// Returns `size`, which must not be negative, with the given sign bit.
inline Float8 with_sign(Float8 size, Integer8 sign) { return as_floats(as_integers(size) | sign); }

inline float horizontal_sum(Float8 value) {
  const std::array<float, 4> four = add_halves(value);
  return (four[0] + four[1]) + (four[2] + four[3]);
}
/// How many lanes of a mask are set.
inline int count_set(Integer8 mask) { return static_cast<int>(horizontal_sum(select(mask, broadcast(1.0f)))); }

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
