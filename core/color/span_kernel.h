#pragma once

#include <array>
#include <cstdint>

#include "core/color/background_box.h"
#include "core/color/color_tables.h"
#include "core/color/nibble_tables.h"
#include "core/cpu.h"
#include "core/types.h"

namespace touchline {

/// What a kernel needs to know about the colors in a row.
struct SpanTables {
  const ColorTables* colors = nullptr;
  const NibbleTables* nibbles = nullptr;  // the same classes for kernels that look up nibbles
  const TileParameters* tiles = nullptr;  // column u is in tiles[u / kTileWidth], or with one light in tiles[0]
  bool unshaded = true;
  bool has_background_box = false;    // there is a BackgroundBox, and the tiles say where
  bool background_from_zero = false;  // all of their background_low are 0

  [[nodiscard]] const TileParameters& tile_at(std::uint32_t u) const { return tiles[unshaded ? 0 : u / kTileWidth]; }
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

/// The kernel of a format for each instruction set, in the folder of that name; the portable one is the reference for
/// all others. A kernel is only defined on its processor family, and must only run where cpu_supports() its set.
SpanKernel portable_kernel(PixelFormat format);
SpanKernel avx2_kernel(PixelFormat format);
SpanKernel avx512_kernel(PixelFormat format);
SpanKernel neon_kernel(PixelFormat format);

/// The kernel of the chosen set. `choice` becomes the set that kFastest stands for. Null: this processor lacks the set.
SpanKernel find_kernel(PixelFormat format, KernelChoice& choice);

}  // namespace touchline
