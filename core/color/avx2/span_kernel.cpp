#include "core/color/span_kernel.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <bit>

#include "core/color/avx2/shaded_row.h"
#include "core/color/kernel_of_format.h"
#include "core/cpu.h"

namespace touchline {
namespace avx2 {
namespace {

// Tables of a row without a light map.
struct RowTables {
  const ChannelNibbles *first, *second, *third;
  const ColorNibbles* colors;
  std::size_t groups;
};
// Keeps the tables of a channel in one register. Otherwise gcc 12 keeps the address of each table, and keeps it in
// memory.
TOUCHLINE_AVX2_INLINE const ChannelNibbles* channel_of(const SpanTables& tables, std::size_t channel) {
  const ChannelNibbles* nibbles = &tables.nibbles->channel(channel, tables.tiles->level[channel]);
  asm("" : "+r"(nibbles));
  return nibbles;
}
TOUCHLINE_AVX2_INLINE RowTables row_tables(const SpanTables& tables) {
  return {channel_of(tables, 0), channel_of(tables, 1), channel_of(tables, 2), &tables.nibbles->colors(),
          tables.nibbles->groups()};
}

TOUCHLINE_AVX2_INLINE Channels<OneBlock> channels_of(const RowTables& tables, const Planes& planes) {
  return {{nibbles_of(OneBlock{planes.first}), tables.first},
          {nibbles_of(OneBlock{planes.second}), tables.second},
          {nibbles_of(OneBlock{planes.third}), tables.third}};
}
TOUCHLINE_AVX2_INLINE Channels<TwoBlocks> channels_of(const RowTables& tables, const Planes& a, const Planes& b) {
  return {{nibbles_of(TwoBlocks{a.first, b.first}), tables.first},
          {nibbles_of(TwoBlocks{a.second, b.second}), tables.second},
          {nibbles_of(TwoBlocks{a.third, b.third}), tables.third}};
}
template <class Values>
TOUCHLINE_AVX2_INLINE Values colors_of(const RowTables& tables, const Channels<Values>& channels) {
  Values colors = colors_in<GroupsInRegister::kOne>(*tables.colors, channels, 0);
  for (std::size_t group = 1; group < tables.groups; ++group) {
    colors = first_of(colors, colors_in<GroupsInRegister::kOne>(*tables.colors, channels, group));
  }
  return colors;
}

// A pass takes up to 64 blocks of a row, one bit each. An incomplete last block is moved to overlap the one before it.
constexpr std::uint32_t kMaxBlocksPerPass = 64;
struct Blocks {
  std::uint32_t first, end;  // columns
  [[nodiscard]] std::uint32_t count() const { return std::min(kMaxBlocksPerPass, (end - first + kBlock - 1) / kBlock); }
  [[nodiscard]] std::uint32_t column(std::uint32_t i) const { return std::min(first + i * kBlock, end - kBlock); }
  // Column of the block with the lowest bit.
  [[nodiscard]] std::uint32_t lowest(std::uint64_t among) const {
    return column(static_cast<std::uint32_t>(std::countr_zero(among)));
  }
};

// Returns bytes that are all zero only if the block is background. Writes background to the block.
template <class Layout>
TOUCHLINE_AVX2_INLINE __m256i candidates_at(const RowPixels& row, std::uint32_t u,
                                            const typename Layout::Background& of_row, ColorId* colors) {
  const __m256i candidates = Layout::candidates(row, u, of_row);
  store(colors + u, _mm256_setzero_si256());
  return candidates;
}

// Returns the blocks that the background box does not reject. Writes background to all blocks.
template <class Layout>
TOUCHLINE_AVX2_INLINE std::uint64_t find_candidates(const SpanTables& tables, const RowPixels& row, Blocks blocks,
                                                    ColorId* colors) {
  const auto of_row = Layout::background(*tables.tiles);
  const RowPixels pixels = row;
  const std::uint32_t count = blocks.count();
  std::uint64_t background = 0;
  std::uint32_t i = 0, u = blocks.first;
  for (; i + 4 <= count && u + 4 * kBlock <= blocks.end; i += 4, u += 4 * kBlock) {
    // Read in the order of addresses, so that the processor prefetches the next bytes.
    const __m256i first = candidates_at<Layout>(pixels, u, of_row, colors),
                  second = candidates_at<Layout>(pixels, u + kBlock, of_row, colors),
                  third = candidates_at<Layout>(pixels, u + 2 * kBlock, of_row, colors),
                  fourth = candidates_at<Layout>(pixels, u + 3 * kBlock, of_row, colors);
    const std::uint64_t halves = zero_halves(first, second, third, fourth);
    background |= (halves & halves >> 4 & 15) << i;
  }
  for (; i < count; ++i) background |= is_zero(candidates_at<Layout>(pixels, blocks.column(i), of_row, colors)) << i;
  return ~background;
}

// Returns the blocks that may contain a class, judged by the high nibbles alone.
template <class Layout>
TOUCHLINE_AVX2_PASS std::uint64_t find_coarse_blocks(const SpanTables& tables, const RowPixels& row, Blocks blocks,
                                                     std::uint64_t among) {
  const RowTables of_row = row_tables(tables);
  const RowPixels pixels = row;
  std::uint64_t found = 0;
  for (; among != 0; among &= among - 1) {
    const Channels<OneBlock> channels = channels_of(of_row, Layout::planes(pixels, blocks.lowest(among)));
    OneBlock near = coarse_classes<GroupsInRegister::kOne>(channels, 0);
    for (std::size_t group = 1; group < of_row.groups; ++group) {
      near = or_of(near, coarse_classes<GroupsInRegister::kOne>(channels, group));
    }
    found |= (among & (~among + 1)) * (1 - is_zero(near.first));
  }
  return found;
}

TOUCHLINE_AVX2_INLINE OccupiedWords occupied_at(std::uint32_t u, __m256i colors) {
  const OccupiedWords is_colored = 1 - is_zero(colors);
  return is_colored << u / kOccupiedWordPixels | is_colored << (u + kTile) / kOccupiedWordPixels;
}

// Classifies the blocks.
template <class Layout>
TOUCHLINE_AVX2_PASS OccupiedWords color_blocks(const SpanTables& tables, const RowPixels& row, Blocks blocks,
                                               std::uint64_t left, ColorId* colors) {
  const RowTables of_row = row_tables(tables);
  const RowPixels pixels = row;
  OccupiedWords occupied = 0;
  while ((left & (left - 1)) != 0) {
    const std::uint32_t u = blocks.lowest(left), v = blocks.lowest(left & (left - 1));
    left &= left - 1;
    left &= left - 1;
    const TwoBlocks found =
        colors_of(of_row, channels_of(of_row, Layout::planes(pixels, u), Layout::planes(pixels, v)));
    store(colors + u, found.first);
    store(colors + v, found.second);
    occupied |= occupied_at(u, found.first) | occupied_at(v, found.second);
  }
  if (left != 0) {
    const std::uint32_t u = blocks.lowest(left);
    const OneBlock found = colors_of(of_row, channels_of(of_row, Layout::planes(pixels, u)));
    store(colors + u, found.first);
    occupied |= occupied_at(u, found.first);
  }
  return occupied;
}

// The span is at least a block wide.
template <class Layout>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_blocks(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                    std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  for (Blocks blocks = {begin, end}; blocks.first < end; blocks.first += kMaxBlocksPerPass * kBlock) {
    const std::uint64_t all = ~std::uint64_t{0} >> (kMaxBlocksPerPass - blocks.count());
    // There are three passes, each more exact and over fewer blocks. No branch depends on the pixels, so none is
    // mispredicted.
    std::uint64_t left = find_candidates<Layout>(tables, row, blocks, colors) & all;
    if (!tables.has_background_box) left = all;
    if (is_second_pass_worthwhile(left, blocks.count())) left = find_coarse_blocks<Layout>(tables, row, blocks, left);
    if (left != 0) occupied |= color_blocks<Layout>(tables, row, blocks, left, colors);
  }
  return occupied;
}

// The code below is for rows with a light map whose tiles have one light level; regions of interest often leave out
// columns of such rows.

// Tiles are tested in groups of eight, or of four where there are no more.
constexpr std::uint32_t kTilesPerShortTest = kTilesPerTest / 2;

// The tiles that cover a span. A pass takes up to 64 tiles, one bit each. The first tiles are aligned to the span's
// begin, the last ones to its end, so the two groups may overlap.
struct Tiles {
  TOUCHLINE_AVX2_INLINE Tiles(std::uint32_t begin, std::uint32_t span_end)
      : first(begin),
        end(std::min(begin + kMaxTilesPerPass * kTile, span_end)),
        count((width() + kTile - 1) / kTile),
        from_begin(count_from_begin()),
        begin_up_to_end(end - count * kTile) {}
  [[nodiscard]] std::uint32_t width() const { return end - first; }
  [[nodiscard]] std::uint32_t column(std::uint32_t i) const {
    return (i < from_begin ? first : begin_up_to_end) + i * kTile;
  }

  std::uint32_t first, end;  // columns
  std::uint32_t count, from_begin;
  std::uint32_t begin_up_to_end;  // column at which the first tile would begin if all tiles lay end to end up to `end`

 private:
  // Returns the number of tiles aligned to the begin: a multiple of eight, for tests of eight tiles. In a narrow span
  // it is four; in a still narrower span, all tiles but the last.
  [[nodiscard]] std::uint32_t count_from_begin() const {
    if (width() >= kTilesPerTest * kTile) return width() / (kTilesPerTest * kTile) * kTilesPerTest;
    return width() >= kTilesPerShortTest * kTile ? kTilesPerShortTest : count - 1;
  }
};

// Takes the lowest tile from `left`, and returns its column.
TOUCHLINE_AVX2_INLINE std::uint32_t take_lowest(const Tiles& tiles, std::uint64_t& left) {
  const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
  left &= left - 1;
  return tiles.column(i);
}

// Sets bit i if tile i of the eight (or four) tiles that begin at column u is background. Writes background to all of
// them.
template <class Layout>
TOUCHLINE_AVX2_INLINE std::uint64_t reject_eight_tiles(const RowPixels& row, std::uint32_t u,
                                                       const typename Layout::Background& of_row, ColorId* colors) {
  const __m256i zero = _mm256_setzero_si256();
  store(colors + u, zero);
  store(colors + u + kBlock, zero);
  store(colors + u + std::size_t{2} * kBlock, zero);
  store(colors + u + std::size_t{3} * kBlock, zero);
  return zero_halves(Layout::candidates(row, u, u + 4 * kTile, of_row),
                     Layout::candidates(row, u + kTile, u + 5 * kTile, of_row),
                     Layout::candidates(row, u + 2 * kTile, u + 6 * kTile, of_row),
                     Layout::candidates(row, u + 3 * kTile, u + 7 * kTile, of_row));
}
template <class Layout>
TOUCHLINE_AVX2_INLINE std::uint64_t reject_four_tiles(const RowPixels& row, std::uint32_t u,
                                                      const typename Layout::Background& of_row, ColorId* colors) {
  const __m256i zero = _mm256_setzero_si256();
  store(colors + u, zero);
  store(colors + u + kBlock, zero);
  return zero_halves(Layout::candidates(row, u, u + 2 * kTile, of_row),
                     Layout::candidates(row, u + kTile, u + 3 * kTile, of_row));
}
template <class Layout>
TOUCHLINE_AVX2_INLINE std::uint64_t reject_tile(const RowPixels& row, std::uint32_t u,
                                                const typename Layout::Background& of_row, ColorId* colors) {
  store_half(colors + u, _mm_setzero_si128());
  return is_zero(Layout::candidates(row, u, u, of_row));
}

// Returns the tiles that the background box does not reject. Writes background to all tiles.
template <class Layout>
TOUCHLINE_AVX2_PASS std::uint64_t find_candidates_among(const SpanTables& tables, const RowPixels& row,
                                                        const Tiles& tiles, ColorId* colors) {
  const auto of_row = Layout::background_of_tiles(*tables.tiles);
  const RowPixels pixels = row;
  const std::uint32_t from_begin = tiles.from_begin, end = tiles.end;
  std::uint64_t background = 0;
  std::uint32_t i = 0, u = tiles.first;
  if (tiles.width() < kTilesPerShortTest * kTile) {
    for (; i < tiles.count; ++i) background |= reject_tile<Layout>(pixels, tiles.column(i), of_row, colors) << i;
    return ~background;
  }
  for (; i + kTilesPerTest <= from_begin; i += kTilesPerTest, u += kTilesPerTest * kTile) {
    background |= reject_eight_tiles<Layout>(pixels, u, of_row, colors) << i;
  }
  if (i < from_begin) background |= reject_four_tiles<Layout>(pixels, u, of_row, colors) << i;
  // The remaining tiles are tested in a group that ends at the span's end.
  const std::uint32_t others = tiles.count - from_begin;
  if (others > kTilesPerShortTest) {
    background |= reject_eight_tiles<Layout>(pixels, end - kTilesPerTest * kTile, of_row, colors) >>
                  (kTilesPerTest - others) << from_begin;
  } else if (others > 0) {
    background |= reject_four_tiles<Layout>(pixels, end - kTilesPerShortTest * kTile, of_row, colors) >>
                  (kTilesPerShortTest - others) << from_begin;
  }
  return ~background;
}

// Returns bits 0 and 1, set if the lower and the upper half are nonzero.
TOUCHLINE_AVX2_INLINE std::uint32_t occupied_halves(__m256i value) {
  const auto zero = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(value, _mm256_setzero_si256())));
  return static_cast<std::uint32_t>((zero & 0xffffu) != 0xffffu) | static_cast<std::uint32_t>(zero >> 16u != 0xffffu)
                                                                       << 1u;
}

// Returns the tiles that may contain a class, judged by the high nibbles alone.
template <class Layout>
TOUCHLINE_AVX2_PASS std::uint64_t find_coarse(const SpanTables& tables, const RowPixels& row, const Tiles& tiles,
                                              std::uint64_t among) {
  const RowTables of_row = row_tables(tables);
  const RowPixels pixels = row;
  std::uint64_t found = 0;
  while (among != 0) {
    const std::uint64_t a = among & (~among + 1);
    const std::uint32_t u = take_lowest(tiles, among);
    const std::uint64_t b = among & (~among + 1);
    const std::uint32_t v = among != 0 ? take_lowest(tiles, among) : u;
    const Channels<OneBlock> channels = channels_of(of_row, Layout::planes(pixels, u, v));
    OneBlock near = coarse_classes<GroupsInRegister::kOne>(channels, 0);
    for (std::size_t group = 1; group < of_row.groups; ++group) {
      near = or_of(near, coarse_classes<GroupsInRegister::kOne>(channels, group));
    }
    const std::uint64_t halves = occupied_halves(near.first);
    found |= a * (halves & 1) | b * (halves >> 1);
  }
  return found;
}

TOUCHLINE_AVX2_INLINE OccupiedWords words_of_tile(std::uint32_t u, OccupiedWords is_colored) {
  return is_colored << u / kOccupiedWordPixels | is_colored << (u + kTile - 1) / kOccupiedWordPixels;
}
// Writes the colors of two tiles.
TOUCHLINE_AVX2_INLINE OccupiedWords write_tiles(std::uint32_t u, std::uint32_t v, __m256i found, ColorId* colors) {
  store_half(colors + u, _mm256_castsi256_si128(found));
  store_half(colors + v, _mm256_extracti128_si256(found, 1));
  const OccupiedWords halves = occupied_halves(found);
  return words_of_tile(u, halves & 1) | words_of_tile(v, halves >> 1);
}

// Classifies the tiles.
template <class Layout>
TOUCHLINE_AVX2_PASS OccupiedWords color_all(const SpanTables& tables, const RowPixels& row, const Tiles& tiles,
                                            std::uint64_t left, ColorId* colors) {
  const RowTables of_row = row_tables(tables);
  const RowPixels pixels = row;
  OccupiedWords occupied = 0;
  while (left != 0) {
    const std::uint32_t a = take_lowest(tiles, left), b = left != 0 ? take_lowest(tiles, left) : a;
    if (left == 0) {
      const OneBlock found = colors_of(of_row, channels_of(of_row, Layout::planes(pixels, a, b)));
      return occupied | write_tiles(a, b, found.first, colors);
    }
    const std::uint32_t c = take_lowest(tiles, left), d = left != 0 ? take_lowest(tiles, left) : c;
    const TwoBlocks found =
        colors_of(of_row, channels_of(of_row, Layout::planes(pixels, a, b), Layout::planes(pixels, c, d)));
    occupied |= write_tiles(a, b, found.first, colors) | write_tiles(c, d, found.second, colors);
  }
  return occupied;
}

// The span is at least a tile wide, and all of its tiles have the same tables.
template <class Layout>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_tiles(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                   std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  for (std::uint32_t first = begin; first < end; first += kMaxTilesPerPass * kTile) {
    const Tiles tiles(first, end);
    const std::uint64_t all = ~std::uint64_t{0} >> (kMaxTilesPerPass - tiles.count);
    // There are three passes, each more exact and over fewer tiles. No branch depends on the pixels of a single tile.
    std::uint64_t left = find_candidates_among<Layout>(tables, row, tiles, colors) & all;
    if (!tables.has_background_box) left = all;
    if (is_second_pass_worthwhile(left, tiles.count)) left = find_coarse<Layout>(tables, row, tiles, left);
    if (left != 0) occupied |= color_all<Layout>(tables, row, tiles, left, colors);
  }
  return occupied;
}

template <class Layout>
TOUCHLINE_AVX2_PASS OccupiedWords classify_tile(const SpanTables& tables, const RowPixels& row, std::uint32_t u,
                                                ColorId* colors) {
  const __m128i found = tile_colors<Layout>(*tables.nibbles, row, u, *tables.tiles);
  store_half(colors + u, found);
  return (1 - is_zero(found)) << u / kOccupiedWordPixels;
}

template <PixelFormat kFormat>
TOUCHLINE_AVX2 OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                           std::uint32_t end, ColorId* colors) {
  using Layout = LayoutOf<kFormat>;
  if (end < begin + kTile) return portable_span_kernel(kFormat)(tables, row, begin, end, colors);
  if (tables.has_one_light) return classify_tiles<Layout>(tables, row, begin, end, colors);
  if (!tables.unshaded) return classify_shaded_span<ShadedLayout<Layout>>(tables, row, begin, end, colors);
  OccupiedWords occupied = 0;
  if (begin % kTile != 0 || end % kTile != 0) occupied = classify_ends<Layout>(tables, row, begin, end, colors);
  const std::uint32_t first = (begin + kTile - 1) / kTile * kTile, stop = end / kTile * kTile;
  if (first >= stop) return occupied;
  if (stop - first < kBlock) return occupied | classify_tile<Layout>(tables, row, first, colors);
  return occupied | classify_blocks<Layout>(tables, row, first, stop, colors);
}

struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<kFormat>;
};

}  // namespace
}  // namespace avx2

SpanKernel avx2_span_kernel(PixelFormat format) { return kernel_of_format<avx2::Family>(format); }

}  // namespace touchline

#endif
