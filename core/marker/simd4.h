#pragma once

#include <array>
#include <cstdint>

#include "core/color_space.h"

namespace touchline {

/// Four values in a register: all supported processors have such registers.
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

/// Bit i: lane i of a comparison is true.
[[gnu::always_inline]] inline std::uint32_t bits_of(Simd4<std::int32_t> is_true) {
  const auto halves = __builtin_bit_cast(std::array<std::uint64_t, 2>, is_true & Simd4<std::int32_t>{1, 2, 4, 8});
  const std::uint64_t both = halves[0] | halves[1];
  return static_cast<std::uint32_t>(both | both >> 32u);
}

}  // namespace touchline
