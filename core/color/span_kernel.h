#pragma once

#include <array>
#include <cstdint>

#include "core/color/background_box.h"
#include "core/color/color_tables.h"
#include "core/color/nibble_tables.h"
#include "core/cpu.h"
#include "core/types.h"

namespace touchline {

/// Tables that a kernel needs for a row.
struct SpanTables {
  const ColorTables* colors = nullptr;
  const NibbleTables* nibbles = nullptr;  // classes of `colors`, arranged for vector kernels
  const TileParameters* tiles = nullptr;  // tiles[u / kTileWidth] is for column u; tiles[0] for all columns if unshaded
  bool unshaded = true;
  bool has_background_box = false;    // the tiles have the ranges of a BackgroundBox
  bool background_from_zero = false;  // background_low is 0 in all tiles
  bool has_one_light = false;         // all tiles of the row are equal
  // Second background range, common to all tiles of the row (BackgroundRanges::find_pale). Null if there is none or it
  // is not worth a test.
  const TileParameters* pale = nullptr;

  [[nodiscard]] const TileParameters& tile_at(std::uint32_t u) const { return tiles[unshaded ? 0 : u / kTileWidth]; }
};

/// Bit i is set if columns 64 i to 64 i + 63 may contain a color. Otherwise all of them are background.
using OccupiedWords = std::uint64_t;
constexpr std::uint32_t kOccupiedWordPixels = 64;
static_assert(kMaxFrameWidth / kOccupiedWordPixels < 64);

/// Classifies the pixels begin <= u < end of a row and writes only their colors[u]. `begin` may be odd. Reads only the
/// bytes of these pixels (with shared chroma, of these pixel pairs). The result is defined as
///   colors[u] = colors->color_of(colors->mask(value, tile_at(u).level)).
/// Returns which words of the span may contain a color; bits of words outside the span are 0.
using SpanKernel = OccupiedWords (*)(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                     std::uint32_t end, ColorId* colors);

/// Return the kernel of a format for each instruction set, from the folder with the set's name. The portable kernel is
/// the reference for all others. A kernel is defined only on its processor family, and may run only where
/// cpu_supports() reports its set.
SpanKernel portable_span_kernel(PixelFormat format);
SpanKernel avx2_span_kernel(PixelFormat format);
SpanKernel neon_span_kernel(PixelFormat format);

/// Returns the kernel of the chosen set. Replaces kFastest in `choice` by the set that it selects. Returns null if this
/// processor lacks the set.
SpanKernel find_span_kernel(PixelFormat format, KernelChoice& choice);

}  // namespace touchline
