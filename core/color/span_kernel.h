#pragma once

#include <array>
#include <cstdint>

#include "core/color/color_tables.h"
#include "core/color/digit_tables.h"
#include "core/color/kernel_choice.h"
#include "core/color/quiet_box.h"
#include "core/types.h"

namespace touchline {

/// What a kernel needs to know about the colors in a row.
struct SpanTables {
  const ColorTables* colors = nullptr;
  const DigitTableSet* digits = nullptr;  // the same classes for kernels that look up digits
  const TileLight* tiles = nullptr;       // column u is in tiles[u / kTileWidth], or with one light in tiles[0]
  bool one_light = true;
  bool has_quiet = false;        // there is a QuietBox, and the tiles say where
  bool quiet_from_zero = false;  // all of their quiet_low are 0

  [[nodiscard]] const TileLight& tile_at(std::uint32_t u) const { return tiles[one_light ? 0 : u / kTileWidth]; }
};

/// The first bytes of a picture's row: interleaved samples, or luma and (NV12) the chroma row that belongs to it.
struct RowPixels {
  const std::uint8_t* samples = nullptr;
  const std::uint8_t* chroma = nullptr;
};

/// Bit i: columns 64 i to 64 i + 63 may hold a color. All of a word whose bit is not set is background.
using OccupiedWords = std::uint64_t;
constexpr std::uint32_t kOccupiedWordPixels = 64;
static_assert(kMaxFrameWidth / kOccupiedWordPixels < 64);

/// Writes colors[u] for begin <= u < end and nothing else; columns count from the row's first pixel, begin may be odd.
/// Reads no byte beyond those of the pixels (and, with shared chroma, pixel pairs) in the span. By definition
///   colors[u] = colors->color_of(colors->mask(value, tile_at(u).level)).
/// Returns which words of the span may hold a color; bits of words beyond the span are 0.
using SpanKernel = OccupiedWords (*)(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                     std::uint32_t end, ColorId* colors);

/// The portable kernel of a format: the reference for all others.
SpanKernel scalar_kernel(PixelFormat format);
/// Null where the processor lacks them, or (AVX-512) one of F, BW, VL, VBMI, BMI2.
SpanKernel avx2_kernel(PixelFormat format);
SpanKernel avx512_kernel(PixelFormat format);
SpanKernel neon_kernel(PixelFormat format);

/// Null when it was asked for by name and is not there. `choice` becomes what kFastest stands for.
SpanKernel find_kernel(PixelFormat format, KernelChoice& choice);

}  // namespace touchline
