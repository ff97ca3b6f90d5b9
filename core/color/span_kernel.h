#pragma once

#include <array>
#include <cstdint>

#include "core/color/background_floor.h"
#include "core/color/color_tables.h"
#include "core/color/digit_tables.h"
#include "core/types.h"

namespace touchline {

/// What a kernel needs to know about the colors in a span of one light level.
struct SpanTables {
  std::array<const ColorTables::Table*, 3> channel{};
  const ColorTables::ColorOfBit* color_of_bit = nullptr;
  const BackgroundFloor* floor = nullptr;
  // The same classes for kernels that look up digits.
  std::array<const ChannelDigits*, 3> digits{};
  const std::array<ColorDigits, kClassGroups>* color_digits = nullptr;
  std::size_t groups = 0;
};

/// The first bytes of a picture's row: interleaved samples, or luma and (NV12) the chroma row that belongs to it.
struct RowPixels {
  const std::uint8_t* samples = nullptr;
  const std::uint8_t* chroma = nullptr;
};

/// Writes colors[u] for begin <= u < end and nothing else; columns count from the row's first pixel, begin may be odd.
/// Reads no byte beyond those of the pixels (and, with shared chroma, pixel pairs) in the span. By definition
///   colors[u] = color_of(channel[0][c0] & channel[1][c1] & channel[2][c2]).
using SpanKernel = void (*)(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                            ColorId* colors);

/// The portable kernel of a format: the reference for all others.
SpanKernel scalar_kernel(PixelFormat format);

/// Null where the processor lacks AVX2.
SpanKernel avx2_kernel(PixelFormat format);

}  // namespace touchline
