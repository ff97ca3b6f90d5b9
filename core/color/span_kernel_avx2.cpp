#include "core/color/digit_lookup_avx2.h"
#include "core/color/kernel_of_format.h"
#include "core/color/span_kernel.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <type_traits>

namespace touchline {
namespace avx2 {
namespace {

// Which bytes are farther above `low` than `reach`: those are not zero.
TOUCHLINE_AVX2_INLINE __m256i beyond(__m256i bytes, __m256i low, __m256i reach) {
  return _mm256_subs_epu8(_mm256_sub_epi8(bytes, low), reach);
}

// A byte shuffle's pattern that takes byte first + step * (i / repeat) of two times 16 as byte i; what is not in this
// 16 is 128, which gives zero.
constexpr std::array<std::array<std::uint8_t, 16>, 3> pick_bytes(std::size_t first, std::size_t step,
                                                                 std::size_t repeat) {
  std::array<std::array<std::uint8_t, 16>, 3> pick{};
  for (std::size_t piece = 0; piece < pick.size(); ++piece) {
    for (std::size_t i = 0; i < 16; ++i) {
      const std::size_t byte = first + step * (i / repeat);
      pick[piece][i] = static_cast<std::uint8_t>(byte / 16 == piece ? byte % 16 : 128);
    }
  }
  return pick;
}

struct Planes {
  __m256i first, second, third;
};

// The layouts below give of a block
// - loud: bytes that are not zero unless all of it is in the quiet box, its columns in one piece,
// - planes: its three channels, chroma doubled; its halves begin at any two columns, of shared chroma even ones.

// Three bytes a pixel.
template <PixelFormat kFormat>
struct Packed24 {
  static constexpr std::array kPick = {pick_bytes(kFormat == PixelFormat::kRgb24 ? 0 : 2, 3, 1), pick_bytes(1, 3, 1),
                                       pick_bytes(kFormat == PixelFormat::kRgb24 ? 2 : 0, 3, 1)};

  // Three bytes over and over, from byte i % 3 on.
  static constexpr auto kPeriod = [] {
    std::array<std::array<std::uint8_t, 32>, 3> period{};
    for (std::size_t i = 0; i < 96; ++i) period[i / 32][i % 32] = static_cast<std::uint8_t>(i % 3);
    return period;
  }();

  // Of the 96 bytes of a block, the first 48 in the tile of the lower half.
  struct Quiet {
    __m256i low[3], reach[3];
  };
  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const Lights& lights) {
    Quiet quiet;
    spread<kOneLight>(four_bytes(lights.low->quiet_low), four_bytes(lights.high->quiet_low), quiet.low);
    spread<kOneLight>(four_bytes(lights.low->quiet_reach), four_bytes(lights.high->quiet_reach), quiet.reach);
    return quiet;
  }
  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static void spread(__m256i low, __m256i high, __m256i out[3]) {
    const __m256i both = kOneLight ? low : _mm256_blend_epi32(low, high, 0b11110000);
    out[0] = _mm256_shuffle_epi8(low, load(kPeriod[0].data()));
    out[1] = _mm256_shuffle_epi8(both, load(kPeriod[1].data()));
    out[2] = _mm256_shuffle_epi8(kOneLight ? low : high, load(kPeriod[2].data()));
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    const std::uint8_t* bytes = row.samples + std::size_t{3} * u;
    return _mm256_or_si256(beyond(load(bytes), quiet.low[0], quiet.reach[0]),
                           _mm256_or_si256(beyond(load(bytes + 32), quiet.low[1], quiet.reach[1]),
                                           beyond(load(bytes + 64), quiet.low[2], quiet.reach[2])));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u_low, std::uint32_t u_high) {
    const std::uint8_t *low = row.samples + std::size_t{3} * u_low, *high = row.samples + std::size_t{3} * u_high;
    const __m256i first = load_halves(low, high), second = load_halves(low + 16, high + 16),
                  third = load_halves(low + 32, high + 32);
    return {channel(0, first, second, third), channel(1, first, second, third), channel(2, first, second, third)};
  }
  TOUCHLINE_AVX2_INLINE static __m256i channel(std::size_t channel, __m256i first, __m256i second, __m256i third) {
    return _mm256_or_si256(_mm256_shuffle_epi8(first, in_both_halves(kPick[channel][0].data())),
                           _mm256_or_si256(_mm256_shuffle_epi8(second, in_both_halves(kPick[channel][1].data())),
                                           _mm256_shuffle_epi8(third, in_both_halves(kPick[channel][2].data()))));
  }
};

// Two bytes a pixel.
template <PixelFormat kFormat>
struct Packed16 {
  static constexpr std::size_t kLumaAt = kFormat == PixelFormat::kYuyv ? 0 : 1, kChromaAt = 1 - kLumaAt;
  static constexpr std::array kPick = {pick_bytes(kLumaAt, 2, 1), pick_bytes(kChromaAt, 4, 2),
                                       pick_bytes(kChromaAt + 2, 4, 2)};

  // A tile's bytes fill a register.
  struct Quiet {
    __m256i low[2], reach[2];
  };
  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const Lights& lights) {
    return {{four_bytes(lights.low->quiet_low), four_bytes(lights.high->quiet_low)},
            {four_bytes(lights.low->quiet_reach), four_bytes(lights.high->quiet_reach)}};
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    const std::uint8_t* bytes = row.samples + std::size_t{2} * u;
    return _mm256_or_si256(beyond(load(bytes), quiet.low[0], quiet.reach[0]),
                           beyond(load(bytes + 32), quiet.low[1], quiet.reach[1]));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u_low, std::uint32_t u_high) {
    const std::uint8_t *low = row.samples + std::size_t{2} * u_low, *high = row.samples + std::size_t{2} * u_high;
    const __m256i first = load_halves(low, high), second = load_halves(low + 16, high + 16);
    return {channel(0, first, second), channel(1, first, second), channel(2, first, second)};
  }
  TOUCHLINE_AVX2_INLINE static __m256i channel(std::size_t channel, __m256i first, __m256i second) {
    return _mm256_or_si256(_mm256_shuffle_epi8(first, in_both_halves(kPick[channel][0].data())),
                           _mm256_shuffle_epi8(second, in_both_halves(kPick[channel][1].data())));
  }
};

// A byte a pixel, and two a pair.
struct Planar {
  static constexpr std::array kPick = {pick_bytes(0, 2, 2), pick_bytes(1, 2, 2)};

  struct Quiet {
    __m256i luma_low, luma_reach, chroma_low, chroma_reach;
  };
  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const Lights& lights) {
    const __m256i low =
        _mm256_blend_epi32(four_bytes(lights.low->quiet_low), four_bytes(lights.high->quiet_low), 0b11110000);
    const __m256i reach =
        _mm256_blend_epi32(four_bytes(lights.low->quiet_reach), four_bytes(lights.high->quiet_reach), 0b11110000);
    const __m256i of_luma = _mm256_setzero_si256(), of_chroma = _mm256_set1_epi16(0x0302);
    return {_mm256_shuffle_epi8(low, of_luma), _mm256_shuffle_epi8(reach, of_luma), _mm256_shuffle_epi8(low, of_chroma),
            _mm256_shuffle_epi8(reach, of_chroma)};
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    return _mm256_or_si256(beyond(load(row.samples + u), quiet.luma_low, quiet.luma_reach),
                           beyond(load(row.chroma + u), quiet.chroma_low, quiet.chroma_reach));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u_low, std::uint32_t u_high) {
    const __m256i chroma = load_halves(row.chroma + u_low, row.chroma + u_high);
    return {load_halves(row.samples + u_low, row.samples + u_high),
            _mm256_shuffle_epi8(chroma, in_both_halves(kPick[0][0].data())),
            _mm256_shuffle_epi8(chroma, in_both_halves(kPick[1][0].data()))};
  }
};

TOUCHLINE_AVX2_INLINE ChannelTables tables_of(const SpanTables& tables, const Lights& lights, std::size_t channel) {
  return {&tables.digits->channel(channel, lights.low->level[channel]),
          &tables.digits->channel(channel, lights.high->level[channel])};
}
TOUCHLINE_AVX2_INLINE BlockTables tables_of(const SpanTables& tables, const Lights& lights) {
  return {{tables_of(tables, lights, 0), tables_of(tables, lights, 1), tables_of(tables, lights, 2)}};
}
TOUCHLINE_AVX2_INLINE Channels<OneBlock> channels_of(const BlockTables& tables, const Planes& planes) {
  return {{digits_of(OneBlock{planes.first}), tables.channel[0]},
          {digits_of(OneBlock{planes.second}), tables.channel[1]},
          {digits_of(OneBlock{planes.third}), tables.channel[2]}};
}
TOUCHLINE_AVX2_INLINE Channels<TwoBlocks> channels_of(const BlockTables& tables, const Planes& a, const Planes& b) {
  return {{digits_of(TwoBlocks{a.first, b.first}), tables.channel[0]},
          {digits_of(TwoBlocks{a.second, b.second}), tables.channel[1]},
          {digits_of(TwoBlocks{a.third, b.third}), tables.channel[2]}};
}

template <bool kOneLight, class Values>
TOUCHLINE_AVX2_INLINE Values colors_in(const SpanTables& tables, const Channels<Values>& channels, std::size_t group) {
  Values classes = near_classes<kOneLight>(channels, group);
  settle(classes);
  narrow<kOneLight>(classes, channels.first, group);
  narrow<kOneLight>(classes, channels.second, group);
  narrow<kOneLight>(classes, channels.third, group);
  return color_of(tables.digits->colors()[group], classes);
}
template <bool kOneLight, class Values>
TOUCHLINE_AVX2_INLINE Values colors_of(const SpanTables& tables, std::size_t groups, const Channels<Values>& channels) {
  Values colors = colors_in<kOneLight>(tables, channels, 0);
  for (std::size_t group = 1; group < groups; ++group) {
    colors = first_of(colors, colors_in<kOneLight>(tables, channels, group));
  }
  return colors;
}

TOUCHLINE_AVX2_INLINE OccupiedWords occupied_at(std::uint32_t u, __m256i colors) {
  return (1 - is_zero(colors)) << u / kOccupiedWordPixels;
}

template <bool kOneLight>
TOUCHLINE_AVX2_INLINE const TileLight* tile_at(const SpanTables& tables, std::uint32_t u) {
  return kOneLight ? tables.tiles : tables.tiles + u / kTile;
}
// Of the tile and the next one.
template <bool kOneLight>
TOUCHLINE_AVX2_INLINE Lights lights_from(const TileLight* tile) {
  return {tile, kOneLight ? tile : tile + 1};
}

// Of the block at u; with one light those of the row.
template <bool kOneLight>
TOUCHLINE_AVX2_INLINE BlockTables tables_at(const SpanTables& tables, const BlockTables& of_row, std::uint32_t u) {
  if constexpr (kOneLight) return of_row;
  return tables_of(tables, lights_from<false>(tile_at<false>(tables, u)));
}

// Up to 64 blocks of a row, a bit each. The last overlaps the one before it when there is no whole one left.
constexpr std::uint32_t kMostBlocks = 64;
struct Blocks {
  std::uint32_t first, end, count;
  [[nodiscard]] std::uint32_t column(std::uint32_t i) const { return std::min(first + i * kBlock, end - kBlock); }
};

// Whether the block is quiet. Makes it background.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE std::uint64_t is_quiet(const RowPixels& row, std::uint32_t u, const TileLight* tile,
                                             const typename Layout::Quiet& of_row, ColorId* colors) {
  const __m256i loud =
      Layout::loud(row, u, kOneLight ? of_row : Layout::template quiet<false>(lights_from<false>(tile)));
  store(colors + u, _mm256_setzero_si256());
  return is_zero(loud);
}

// The blocks that are not quiet. Makes all of them background.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE std::uint64_t find_loud(const SpanTables& tables, const RowPixels& row, const Blocks& blocks,
                                              ColorId* colors) {
  const TileLight* tile = tile_at<kOneLight>(tables, blocks.first);
  const auto of_row = Layout::template quiet<kOneLight>(lights_from<kOneLight>(tile));
  std::uint64_t quiet = 0;
  std::uint32_t i = 0, u = blocks.first;
  for (; u + 4 * kBlock <= blocks.end && i < kMostBlocks; i += 4, u += 4 * kBlock) {
    const std::uint64_t first = is_quiet<Layout, kOneLight>(row, u, tile, of_row, colors),
                        second = is_quiet<Layout, kOneLight>(row, u + kBlock, tile + 2, of_row, colors),
                        third = is_quiet<Layout, kOneLight>(row, u + 2 * kBlock, tile + 4, of_row, colors),
                        fourth = is_quiet<Layout, kOneLight>(row, u + 3 * kBlock, tile + 6, of_row, colors);
    quiet |= (first | second << 1 | third << 2 | fourth << 3) << i;
    if constexpr (!kOneLight) tile += 8;
  }
  for (; i < blocks.count; ++i) {
    u = blocks.column(i);
    quiet |= is_quiet<Layout, kOneLight>(row, u, tile_at<kOneLight>(tables, u), of_row, colors) << i;
  }
  const std::uint64_t all = blocks.count == kMostBlocks ? ~std::uint64_t{0} : (std::uint64_t{1} << blocks.count) - 1;
  return tables.has_quiet ? all & ~quiet : all;
}

// Those of the blocks that may have a class, by high digits alone.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE std::uint64_t find_near(const SpanTables& tables, const BlockTables& of_row, const RowPixels& row,
                                              const Blocks& blocks, std::uint64_t among) {
  const std::size_t groups = tables.digits->groups();
  std::uint64_t found = 0;
  for (; among != 0; among &= among - 1) {
    const std::uint32_t u = blocks.column(static_cast<std::uint32_t>(std::countr_zero(among)));
    const Channels<OneBlock> channels =
        channels_of(tables_at<kOneLight>(tables, of_row, u), Layout::planes(row, u, u + kTile));
    OneBlock near = near_classes<kOneLight>(channels, 0);
    for (std::size_t group = 1; group < groups; ++group) near = or_of(near, near_classes<kOneLight>(channels, group));
    found |= (among & (~among + 1)) * (1 - is_zero(near.first));
  }
  return found;
}

// Whole tiles, at least one.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_tiles(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                   std::uint32_t end, ColorId* colors) {
  if (end - begin < kBlock) {
    const TileLight* tile = tile_at<kOneLight>(tables, begin);
    const OneBlock found =
        colors_of<kOneLight>(tables, tables.digits->groups(),
                             channels_of(tables_of(tables, {tile, tile}), Layout::planes(row, begin, begin)));
    store_half(colors + begin, _mm256_castsi256_si128(found.first));
    return occupied_at(begin, found.first);
  }
  const BlockTables of_row = tables_of(tables, lights_from<kOneLight>(tables.tiles));
  const std::size_t groups = tables.digits->groups();
  OccupiedWords occupied = 0;
  const auto next_column = [](const Blocks& blocks, std::uint64_t& left) {
    const std::uint32_t u = blocks.column(static_cast<std::uint32_t>(std::countr_zero(left)));
    left &= left - 1;
    return u;
  };
  for (std::uint32_t first = begin; first < end; first += kMostBlocks * kBlock) {
    const Blocks blocks = {first, end, std::min(kMostBlocks, (end - first + kBlock - 1) / kBlock)};
    // Three looks, each closer and at fewer blocks. No branch depends on what is there: no wrong guess costs time.
    std::uint64_t left = find_loud<Layout, kOneLight>(tables, row, blocks, colors);
    if (is_second_look_worth(left, blocks.count)) {
      left = find_near<Layout, kOneLight>(tables, of_row, row, blocks, left);
    }
    while (kOneLight && (left & (left - 1)) != 0) {
      const std::uint32_t u = next_column(blocks, left), v = next_column(blocks, left);
      const TwoBlocks found = colors_of<kOneLight>(
          tables, groups, channels_of(of_row, Layout::planes(row, u, u + kTile), Layout::planes(row, v, v + kTile)));
      store(colors + u, found.first);
      store(colors + v, found.second);
      occupied |= occupied_at(u, found.first) | occupied_at(u + kTile, found.first) | occupied_at(v, found.second) |
                  occupied_at(v + kTile, found.second);
    }
    while (left != 0) {
      const std::uint32_t u = next_column(blocks, left);
      const OneBlock found = colors_of<kOneLight>(
          tables, groups, channels_of(tables_at<kOneLight>(tables, of_row, u), Layout::planes(row, u, u + kTile)));
      store(colors + u, found.first);
      occupied |= occupied_at(u, found.first) | occupied_at(u + kTile, found.first);
    }
  }
  return occupied;
}

// The parts of tiles at the span's ends, less than a tile each, as one block: from the first pixel on, and up to the
// last. The span is a tile wide at least.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_ends(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                  std::uint32_t end, ColorId* colors) {
  const std::uint32_t last = end - kTile;
  const auto of_first = static_cast<char>((kTile - begin % kTile) % kTile),
             before_last = static_cast<char>(kTile - end % kTile);
  const Lights lights = {tile_at<kOneLight>(tables, begin), tile_at<kOneLight>(tables, end - 1)};
  const OneBlock found = colors_of<kOneLight>(tables, tables.digits->groups(),
                                              channels_of(tables_of(tables, lights), Layout::planes(row, begin, last)));
  const __m128i place = _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m128i first_colors =
      _mm_and_si128(_mm256_castsi256_si128(found.first), _mm_cmplt_epi8(place, _mm_set1_epi8(of_first)));
  const __m128i last_colors =
      _mm_andnot_si128(_mm_cmplt_epi8(place, _mm_set1_epi8(before_last)), _mm256_extracti128_si256(found.first, 1));
  // The two may overlap each other.
  store_half(colors + last, _mm_setzero_si128());
  store_half(colors + begin, first_colors);
  store_half(colors + last, _mm_or_si128(load_half(colors + last), last_colors));
  return occupied_at(begin, _mm256_zextsi128_si256(first_colors)) |
         occupied_at(end - 1, _mm256_zextsi128_si256(last_colors));
}

template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_light(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                   std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  if (begin % kTile != 0 || end % kTile != 0)
    occupied = classify_ends<Layout, kOneLight>(tables, row, begin, end, colors);
  const std::uint32_t first = (begin + kTile - 1) / kTile * kTile, stop = end / kTile * kTile;
  if (first < stop) occupied |= classify_tiles<Layout, kOneLight>(tables, row, first, stop, colors);
  return occupied;
}

template <PixelFormat kFormat, class Layout>
TOUCHLINE_AVX2 OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                           std::uint32_t end, ColorId* colors) {
  if (end < begin + kTile) return scalar_kernel(kFormat)(tables, row, begin, end, colors);
  // Copies: what is written to `colors` cannot change them.
  const SpanTables of_row = tables;
  const RowPixels pixels = row;
  return tables.one_light ? classify_light<Layout, true>(of_row, pixels, begin, end, colors)
                          : classify_light<Layout, false>(of_row, pixels, begin, end, colors);
}

template <PixelFormat kFormat>
using LayoutOf = std::conditional_t<color_space(kFormat) == ColorSpace::kRgb, Packed24<kFormat>,
                                    std::conditional_t<kFormat == PixelFormat::kNv12, Planar, Packed16<kFormat>>>;
struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<kFormat, LayoutOf<kFormat>>;
};

}  // namespace
}  // namespace avx2

SpanKernel avx2_kernel(PixelFormat format) {
  __builtin_cpu_init();
  const bool is_there = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0 &&
                        __builtin_cpu_supports("popcnt") != 0;
  return is_there ? kernel_of_format<avx2::Family>(format) : nullptr;
}

}  // namespace touchline

#else

namespace touchline {

SpanKernel avx2_kernel(PixelFormat) { return nullptr; }

}  // namespace touchline

#endif
