#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/color_space.h"

namespace touchline {

/// Four values in a register, which all supported processors have.
template <class T>
using Simd4 [[gnu::vector_size(16)]] = T;

/// Converts four pixel values in YUV to R, G, B above black, with the same results as to_rgb() of surface_color.h.
[[gnu::always_inline]] inline std::array<Simd4<float>, 3> yuv_to_rgb4(const std::array<Simd4<float>, 3>& value,
                                                                      ColorSpace space) {
  const auto number = [](int integer) { return static_cast<float>(integer); };
  const auto black = [&](std::size_t c) { return number(black_value(space, c)); };
  const YuvToRgb yuv = yuv_to_rgb(space);
  const Simd4<float> u = value[1] - black(1), v = value[2] - black(2);
  const Simd4<float> bright = number(yuv.luma) * (value[0] - black(0));
  std::array<Simd4<float>, 3> rgb{bright + number(yuv.red_v) * v,
                                  bright - number(yuv.green_u) * u - number(yuv.green_v) * v,
                                  bright + number(yuv.blue_u) * u};
  for (Simd4<float>& channel : rgb) {
    channel /= float{YuvToRgb::kOne};
    channel = channel > 0.0f ? channel : Simd4<float>{};
  }
  return rgb;
}

/// Natural logarithm of positive normal numbers, to one unit in the last place (polynomial of the Cephes library,
/// Moshier 1992). Unlike std::log, it gives identical bits on every processor.
[[gnu::always_inline]] inline Simd4<float> logarithm(Simd4<float> x) {
  constexpr std::array kCoefficients{7.0376836292e-2f,  -1.1514610310e-1f, 1.1676998740e-1f,
                                     -1.2420140846e-1f, 1.4249322787e-1f,  -1.6668057665e-1f,
                                     2.0000714765e-1f,  -2.4999993993e-1f, 3.3333331174e-1f};
  // log(2) as a sum of two numbers; products of an exponent with the first are exact.
  constexpr float kLog2High = 0.693359375f, kLog2Low = -2.12194440e-4f;
  constexpr std::int32_t kOne = 0x3f800000, kRootOfHalf = 0x3f3504f3, kFraction = 0x007fffff;
  // x = 2^exponent (1 + f), where 1 + f is between the roots of 1/2 and 2.
  const auto bits = __builtin_bit_cast(Simd4<std::int32_t>, x) + (kOne - kRootOfHalf);
  const Simd4<float> exponent = __builtin_convertvector((bits >> 23) - 127, Simd4<float>);
  const Simd4<float> f = __builtin_bit_cast(Simd4<float>, (bits & kFraction) + kRootOfHalf) - 1.0f;
  const Simd4<float> square = f * f;
  // Sum in pairs (Estrin 1960), several of which a processor computes at once.
  const auto& k = kCoefficients;
  const Simd4<float> fourth = square * square;
  const Simd4<float> low = (k[7] * f + k[8]) + (k[5] * f + k[6]) * square;
  const Simd4<float> high = (k[3] * f + k[4]) + (k[1] * f + k[2]) * square;
  const Simd4<float> polynomial = low + (high + k[0] * fourth) * fourth;
  const Simd4<float> rest = polynomial * f * square + kLog2Low * exponent - 0.5f * square;
  return (f + rest) + kLog2High * exponent;
}

/// Square root, with the rounding of std::sqrt.
[[gnu::always_inline]] inline Simd4<float> square_root(Simd4<float> x) {
#if defined(__SSE__)
  return __builtin_ia32_sqrtps(x);
#else
  for (std::size_t lane = 0; lane < 4; ++lane) x[lane] = std::sqrt(x[lane]);
  return x;
#endif
}

/// Returns whether a comparison is true in any lane.
[[gnu::always_inline]] inline bool any(Simd4<std::int32_t> is_true) {
  const auto halves = __builtin_bit_cast(std::array<std::uint64_t, 2>, is_true);
  return (halves[0] | halves[1]) != 0;
}

/// Returns a mask; bit i is set if lane i of a comparison is true.
[[gnu::always_inline]] inline std::uint32_t bits_of(Simd4<std::int32_t> is_true) {
  const auto halves = __builtin_bit_cast(std::array<std::uint64_t, 2>, is_true & Simd4<std::int32_t>{1, 2, 4, 8});
  const std::uint64_t both = halves[0] | halves[1];
  return static_cast<std::uint32_t>(both | both >> 32u);
}

[[gnu::always_inline]] inline float sum_of_lanes(Simd4<float> four) {
  return (four[0] + four[1]) + (four[2] + four[3]);
}

/// Calls use(numbers, is_set) with four neighboring bits at a time: their numbers, and the lanes in which the bit is
/// set.
template <class Use>
[[gnu::always_inline]] inline void for_each_four(std::uint64_t bits, const Use& use) {
  for (int i = std::countr_zero(bits); i < static_cast<int>(std::bit_width(bits)); i += 4) {
    const auto four = static_cast<std::int32_t>(bits >> static_cast<unsigned>(i) & 15u);
    use(Simd4<float>{0, 1, 2, 3} + static_cast<float>(i), (four & Simd4<std::int32_t>{1, 2, 4, 8}) != 0);
  }
}

}  // namespace touchline
