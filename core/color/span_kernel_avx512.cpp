#include "core/color/kernel_of_format.h"
#include "core/color/span_kernel.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <type_traits>

namespace touchline {
namespace {

// As for AVX2, every function carries the target itself.
#define TOUCHLINE_AVX512_TARGET "avx512f,avx512bw,avx512vl,avx512vbmi,bmi,popcnt"
#define TOUCHLINE_AVX512 [[gnu::target(TOUCHLINE_AVX512_TARGET)]]
#define TOUCHLINE_AVX512_INLINE [[gnu::target(TOUCHLINE_AVX512_TARGET), gnu::always_inline]] inline

// A block is a word of 64 columns; a quarter of a register is a tile, which has its own tables.
constexpr std::uint32_t kBlock = kOccupiedWordPixels;
static_assert(kTileWidth == 16 && kBlock == 4 * kTileWidth);

// Those of a block's pixels that are in the span: a bit each.
using Inside = std::uint64_t;
constexpr Inside kWhole = ~Inside{0};
constexpr Inside bits(std::uint32_t begin, std::uint32_t end) { return kWhole >> (64 - (end - begin)) << begin; }

// Those of the bytes 64 * piece to 64 * piece + 63 that are in begin..end - 1.
constexpr std::uint64_t bytes_inside(std::uint32_t begin, std::uint32_t end, std::uint32_t piece) {
  const std::uint32_t low = std::clamp(begin, 64 * piece, 64 * piece + 64),
                      high = std::clamp(end, low, 64 * piece + 64);
  return low == high ? 0 : bits(low - 64 * piece, high - 64 * piece);
}

// Where a block is and what of it may be read: pixels begin to end - 1 of its 64.
struct Block {
  std::uint32_t u, begin, end;
  [[nodiscard]] bool is_whole() const { return end - begin == kBlock; }
  [[nodiscard]] Inside inside() const { return bits(begin, end); }
};

// 64 bytes, of which those outside are neither read nor anything but 0. `begin` and `end` count bytes of the block.
template <bool kIsWhole>
TOUCHLINE_AVX512_INLINE __m512i load(const std::uint8_t* bytes, std::uint32_t begin, std::uint32_t end,
                                     std::uint32_t piece) {
  if constexpr (kIsWhole) return _mm512_loadu_si512(bytes + std::size_t{64} * piece);
  return _mm512_maskz_loadu_epi8(bytes_inside(begin, end, piece), bytes + std::size_t{64} * piece);
}
TOUCHLINE_AVX512_INLINE __m512i constant(const std::array<std::uint8_t, 64>& bytes) {
  return _mm512_loadu_si512(bytes.data());
}
TOUCHLINE_AVX512_INLINE __m512i or_of(__m512i a, __m512i b, __m512i c) {
  return _mm512_ternarylogic_epi64(a, b, c, 0b11111110);
}
TOUCHLINE_AVX512_INLINE __m512i and_of(__m512i a, __m512i b, __m512i c) {
  return _mm512_ternarylogic_epi64(a, b, c, 0b10000000);
}
// (a | b) & (c | d) & e
TOUCHLINE_AVX512_INLINE __m512i both_and(__m512i a, __m512i b, __m512i c, __m512i d, __m512i e) {
  return _mm512_ternarylogic_epi64(_mm512_or_si512(a, b), _mm512_or_si512(c, d), e, 0b10000000);
}

using Table = std::array<std::uint8_t, 16>;
TOUCHLINE_AVX512_INLINE __m128i load_table(const Table& table) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(table.data()));
}
TOUCHLINE_AVX512_INLINE __m512i in_all_tiles(const Table& table) {
  return _mm512_maskz_broadcast_i32x4(0xffff, load_table(table));
}

// The tables of a channel's values in the four tiles of a block.
struct TileDigits {
  const ChannelDigits* of[4];
};

template <bool kOneLight>
TOUCHLINE_AVX512_INLINE __m512i tables_of(const TileDigits& digits, std::size_t group, Table DigitTables::*table) {
  if constexpr (kOneLight) return in_all_tiles((*digits.of[0])[group].*table);
  const __m256i low = _mm256_inserti128_si256(_mm256_castsi128_si256(load_table((*digits.of[0])[group].*table)),
                                              load_table((*digits.of[1])[group].*table), 1);
  const __m256i high = _mm256_inserti128_si256(_mm256_castsi128_si256(load_table((*digits.of[2])[group].*table)),
                                               load_table((*digits.of[3])[group].*table), 1);
  return _mm512_maskz_inserti64x4(0xff, _mm512_castsi256_si512(low), high, 1);
}

// A channel's values by their hexadecimal digits, and their tables.
struct Channel {
  __m512i high, low;
  TileDigits digits;
};
struct Channels {
  Channel first, second, third;
};

TOUCHLINE_AVX512_INLINE __m512i high_digits(__m512i values) {
  return _mm512_and_si512(_mm512_srli_epi16(values, 4), _mm512_set1_epi8(15));
}
TOUCHLINE_AVX512_INLINE __m512i low_digits(__m512i values) { return _mm512_and_si512(values, _mm512_set1_epi8(15)); }

template <bool kOneLight>
TOUCHLINE_AVX512_INLINE __m512i near_classes(const Channel& channel, std::size_t group) {
  return _mm512_shuffle_epi8(tables_of<kOneLight>(channel.digits, group, &DigitTables::within), channel.high);
}
// The group's classes of which all three intervals' high digits include the values'.
template <bool kOneLight>
TOUCHLINE_AVX512_INLINE __m512i near_classes(const Channels& channels, std::size_t group) {
  return and_of(near_classes<kOneLight>(channels.first, group), near_classes<kOneLight>(channels.second, group),
                near_classes<kOneLight>(channels.third, group));
}

// Out of the near classes those to which the values of a channel belong, a byte a value.
template <bool kOneLight>
TOUCHLINE_AVX512_INLINE __m512i classes_of(const Channel& channel, std::size_t group, __m512i near) {
  const TileDigits& digits = channel.digits;
  return both_and(_mm512_shuffle_epi8(tables_of<kOneLight>(digits, group, &DigitTables::above_first), channel.high),
                  _mm512_shuffle_epi8(tables_of<kOneLight>(digits, group, &DigitTables::from_first), channel.low),
                  _mm512_shuffle_epi8(tables_of<kOneLight>(digits, group, &DigitTables::below_last), channel.high),
                  _mm512_shuffle_epi8(tables_of<kOneLight>(digits, group, &DigitTables::to_last), channel.low), near);
}

// The color of the lowest class; where an earlier group has given a color, that.
TOUCHLINE_AVX512_INLINE __m512i add_colors(__m512i colors, const ColorDigits& tables, __m512i classes) {
  const __m512i low = _mm512_shuffle_epi8(in_all_tiles(tables.low), low_digits(classes));
  const __m512i color =
      _mm512_mask_shuffle_epi8(low, _mm512_testn_epi8_mask(low, low), in_all_tiles(tables.high), high_digits(classes));
  return _mm512_mask_mov_epi8(colors, _mm512_testn_epi8_mask(colors, colors), color);
}

// For byte i the byte first + step * (i / repeat), modulo 128.
constexpr std::array<std::uint8_t, 64> pick_bytes(std::size_t first, std::size_t step, std::size_t repeat) {
  std::array<std::uint8_t, 64> pick{};
  for (std::size_t i = 0; i < 64; ++i) pick[i] = static_cast<std::uint8_t>((first + step * (i / repeat)) % 128);
  return pick;
}

// The lights of the four tiles lie side by side in a register, 12 bytes each.
constexpr std::uint32_t kLightBytes = sizeof(TileLight);
static_assert(kLightBytes == 12);
constexpr std::size_t kQuietLow = offsetof(TileLight, quiet_low), kQuietReach = offsetof(TileLight, quiet_reach);

// For bytes 64 * piece to 64 * piece + 63 of a block, of which a tile has `tile_bytes`: those of the tile's light from
// `at` on, `period` of them over and over.
constexpr std::array<std::uint8_t, 64> of_light(std::size_t piece, std::size_t tile_bytes, std::size_t at,
                                                std::size_t period) {
  std::array<std::uint8_t, 64> pick{};
  for (std::size_t i = 0; i < 64; ++i) {
    const std::size_t byte = 64 * piece + i;
    pick[i] = static_cast<std::uint8_t>(byte / tile_bytes * kLightBytes + at + byte % tile_bytes % period);
  }
  return pick;
}
// A single light four times.
constexpr auto kFourTimes = [] {
  std::array<std::uint8_t, 64> pick{};
  for (std::size_t i = 0; i < 64; ++i) pick[i] = static_cast<std::uint8_t>(i % kLightBytes);
  return pick;
}();

TOUCHLINE_AVX512_INLINE __m512i choose(__m512i bytes, const std::array<std::uint8_t, 64>& pick) {
  return _mm512_maskz_permutexvar_epi8(kWhole, constant(pick), bytes);
}
TOUCHLINE_AVX512_INLINE __m512i choose(__m512i first, __m512i second, const std::array<std::uint8_t, 64>& pick) {
  return _mm512_permutex2var_epi8(first, constant(pick), second);
}

// Which bytes are farther above `low` than `reach`: those are not zero.
TOUCHLINE_AVX512_INLINE __m512i beyond(__m512i bytes, __m512i low, __m512i reach) {
  return _mm512_subs_epu8(_mm512_sub_epi8(bytes, low), reach);
}

struct Planes {
  __m512i first, second, third;
};

// The layouts below give of a block
// - loud: bytes that are not zero unless all of it is in the quiet box, also where nothing is inside,
// - planes: its three channels, chroma doubled.

// Three bytes a pixel.
template <PixelFormat kFormat>
struct Packed24 {
  static constexpr std::size_t kRed = kFormat == PixelFormat::kRgb24 ? 0 : 2;
  static constexpr std::array kPick = {pick_bytes(kRed, 3, 1), pick_bytes(1, 3, 1), pick_bytes(2 - kRed, 3, 1)};
  // Those pixels whose byte is among the third 64.
  static constexpr std::uint64_t in_third(std::size_t offset) {
    std::uint64_t pixels = 0;
    for (std::size_t i = 0; i < 64; ++i) pixels |= std::uint64_t{3 * i + offset >= 128} << i;
    return pixels;
  }
  static constexpr std::array kInThird = {in_third(kRed), in_third(1), in_third(2 - kRed)};
  static constexpr std::array kReach = {of_light(0, 48, kQuietReach, 3), of_light(1, 48, kQuietReach, 3),
                                        of_light(2, 48, kQuietReach, 3)};

  // Quiet values begin at 0.
  struct Quiet {
    __m512i first, second, third;
  };
  TOUCHLINE_AVX512_INLINE static Quiet quiet(__m512i lights) {
    return {choose(lights, kReach[0]), choose(lights, kReach[1]), choose(lights, kReach[2])};
  }
  struct Bytes {
    __m512i first, second, third;
  };
  template <bool kIsWhole>
  TOUCHLINE_AVX512_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    const std::uint8_t* bytes = row.samples + std::size_t{3} * block.u;
    const std::uint32_t begin = 3 * block.begin, end = 3 * block.end;
    return {load<kIsWhole>(bytes, begin, end, 0), load<kIsWhole>(bytes, begin, end, 1),
            load<kIsWhole>(bytes, begin, end, 2)};
  }
  TOUCHLINE_AVX512_INLINE static __m512i loud(const Bytes& bytes, const Quiet& quiet) {
    return or_of(_mm512_subs_epu8(bytes.first, quiet.first), _mm512_subs_epu8(bytes.second, quiet.second),
                 _mm512_subs_epu8(bytes.third, quiet.third));
  }
  TOUCHLINE_AVX512_INLINE static Planes planes(const Bytes& bytes) {
    return {channel(bytes, 0), channel(bytes, 1), channel(bytes, 2)};
  }
  TOUCHLINE_AVX512_INLINE static __m512i channel(const Bytes& bytes, std::size_t channel) {
    const __m512i of_first_two = choose(bytes.first, bytes.second, kPick[channel]);
    return _mm512_mask_permutexvar_epi8(of_first_two, kInThird[channel], constant(kPick[channel]), bytes.third);
  }
};

// Two bytes a pixel.
template <PixelFormat kFormat>
struct Packed16 {
  static constexpr std::size_t kLumaAt = kFormat == PixelFormat::kYuyv ? 0 : 1, kChromaAt = 1 - kLumaAt;
  static constexpr std::array kPick = {pick_bytes(kLumaAt, 2, 1), pick_bytes(kChromaAt, 4, 2),
                                       pick_bytes(kChromaAt + 2, 4, 2)};
  static constexpr std::array kLow = {of_light(0, 32, kQuietLow, 4), of_light(1, 32, kQuietLow, 4)};
  static constexpr std::array kReach = {of_light(0, 32, kQuietReach, 4), of_light(1, 32, kQuietReach, 4)};

  struct Quiet {
    __m512i first_low, second_low, first_reach, second_reach;
  };
  TOUCHLINE_AVX512_INLINE static Quiet quiet(__m512i lights) {
    return {choose(lights, kLow[0]), choose(lights, kLow[1]), choose(lights, kReach[0]), choose(lights, kReach[1])};
  }
  struct Bytes {
    __m512i first, second;
  };
  template <bool kIsWhole>
  TOUCHLINE_AVX512_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    const std::uint8_t* bytes = row.samples + std::size_t{2} * block.u;
    const std::uint32_t begin = 2 * block.begin, end = 2 * block.end;
    return {load<kIsWhole>(bytes, begin, end, 0), load<kIsWhole>(bytes, begin, end, 1)};
  }
  TOUCHLINE_AVX512_INLINE static __m512i loud(const Bytes& bytes, const Quiet& quiet) {
    return _mm512_or_si512(beyond(bytes.first, quiet.first_low, quiet.first_reach),
                           beyond(bytes.second, quiet.second_low, quiet.second_reach));
  }
  TOUCHLINE_AVX512_INLINE static Planes planes(const Bytes& bytes) {
    return {choose(bytes.first, bytes.second, kPick[0]), choose(bytes.first, bytes.second, kPick[1]),
            choose(bytes.first, bytes.second, kPick[2])};
  }
};

// A byte a pixel, and two a pair.
struct Planar {
  static constexpr std::array kPick = {pick_bytes(0, 2, 2), pick_bytes(1, 2, 2)};
  static constexpr std::array kLow = {of_light(0, 16, kQuietLow, 1), of_light(0, 16, kQuietLow + 2, 2)};
  static constexpr std::array kReach = {of_light(0, 16, kQuietReach, 1), of_light(0, 16, kQuietReach + 2, 2)};

  struct Quiet {
    __m512i luma_low, chroma_low, luma_reach, chroma_reach;
  };
  TOUCHLINE_AVX512_INLINE static Quiet quiet(__m512i lights) {
    return {choose(lights, kLow[0]), choose(lights, kLow[1]), choose(lights, kReach[0]), choose(lights, kReach[1])};
  }
  struct Bytes {
    __m512i luma, chroma;
  };
  template <bool kIsWhole>
  TOUCHLINE_AVX512_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    return {load<kIsWhole>(row.samples + block.u, block.begin, block.end, 0),
            load<kIsWhole>(row.chroma + block.u, block.begin, block.end, 0)};
  }
  TOUCHLINE_AVX512_INLINE static __m512i loud(const Bytes& bytes, const Quiet& quiet) {
    return _mm512_or_si512(beyond(bytes.luma, quiet.luma_low, quiet.luma_reach),
                           beyond(bytes.chroma, quiet.chroma_low, quiet.chroma_reach));
  }
  TOUCHLINE_AVX512_INLINE static Planes planes(const Bytes& bytes) {
    return {bytes.luma, choose(bytes.chroma, kPick[0]), choose(bytes.chroma, kPick[1])};
  }
};

// The lights of the block's tiles; those that are wholly outside are not looked at.
template <bool kOneLight>
TOUCHLINE_AVX512_INLINE __m512i lights_at(const SpanTables& tables, const Block& block) {
  if constexpr (kOneLight) {
    return choose(_mm512_maskz_loadu_epi8(bits(0, kLightBytes), tables.tiles), kFourTimes);
  }
  const std::uint32_t first = block.begin / kTileWidth, last = (block.end - 1) / kTileWidth;
  return _mm512_maskz_loadu_epi8(bits(first * kLightBytes, (last + 1) * kLightBytes),
                                 tables.tiles + block.u / kTileWidth);
}

template <bool kOneLight>
TOUCHLINE_AVX512_INLINE Channel channel_of(const SpanTables& tables, __m512i values, const Block& block,
                                           std::size_t channel) {
  TileDigits digits{};
  if constexpr (kOneLight) {
    digits.of[0] = &tables.digits->channel(channel, tables.tiles->level[channel]);
  } else {
    const TileLight* tiles = tables.tiles + block.u / kTileWidth;
    const std::uint32_t first = block.begin / kTileWidth, last = (block.end - 1) / kTileWidth;
    for (std::uint32_t i = 0; i < 4; ++i) {
      digits.of[i] = &tables.digits->channel(channel, tiles[std::clamp(i, first, last)].level[channel]);
    }
  }
  return {high_digits(values), low_digits(values), digits};
}
template <bool kOneLight>
TOUCHLINE_AVX512_INLINE Channels channels_of(const SpanTables& tables, const Planes& planes, const Block& block) {
  return {channel_of<kOneLight>(tables, planes.first, block, 0), channel_of<kOneLight>(tables, planes.second, block, 1),
          channel_of<kOneLight>(tables, planes.third, block, 2)};
}

// Whether some pixel, inside or not, has a class by high digits alone.
template <bool kOneLight>
TOUCHLINE_AVX512_INLINE bool is_near(const SpanTables& tables, const Channels& channels) {
  __m512i near = _mm512_setzero_si512();
  for (std::size_t group = 0; group < tables.digits->groups(); ++group) {
    near = _mm512_or_si512(near, near_classes<kOneLight>(channels, group));
  }
  return _mm512_test_epi8_mask(near, near) != 0;
}

template <bool kOneLight>
TOUCHLINE_AVX512_INLINE __m512i colors_of(const SpanTables& tables, const Channels& channels) {
  __m512i colors = _mm512_setzero_si512();
  for (std::size_t group = 0; group < tables.digits->groups(); ++group) {
    __m512i classes = near_classes<kOneLight>(channels, group);
    if (_mm512_test_epi8_mask(classes, classes) == 0) continue;
    classes = classes_of<kOneLight>(channels.first, group, classes);
    classes = classes_of<kOneLight>(channels.second, group, classes);
    classes = classes_of<kOneLight>(channels.third, group, classes);
    colors = add_colors(colors, tables.digits->colors()[group], classes);
  }
  return colors;
}

// The blocks that a span meets, a bit each: the words of the row.
struct Span {
  std::uint32_t begin, end;
  [[nodiscard]] Block block(std::uint32_t word) const {
    const std::uint32_t u = word * kBlock;
    return {u, std::max(begin, u) - u, std::min(end, u + kBlock) - u};
  }
};

template <class Layout, bool kOneLight, bool kIsWhole>
TOUCHLINE_AVX512_INLINE OccupiedWords is_loud(const SpanTables& tables, const RowPixels& row, const Block& block,
                                              const typename Layout::Quiet& of_row, ColorId* colors) {
  const typename Layout::Bytes bytes = Layout::template bytes_of<kIsWhole>(row, block);
  const __m512i loud = Layout::loud(bytes, kOneLight ? of_row : Layout::quiet(lights_at<false>(tables, block)));
  if constexpr (kIsWhole) {
    _mm512_storeu_si512(colors + block.u, _mm512_setzero_si512());
  } else {
    _mm512_mask_storeu_epi8(colors + block.u, block.inside(), _mm512_setzero_si512());
  }
  return OccupiedWords{_mm512_test_epi8_mask(loud, loud) != 0};
}

template <class Layout, bool kOneLight>
TOUCHLINE_AVX512_INLINE Channels channels_at(const SpanTables& tables, const RowPixels& row, const Block& block) {
  return channels_of<kOneLight>(tables, Layout::planes(Layout::template bytes_of<false>(row, block)), block);
}

// Three looks at the row, as in the AVX2 kernel.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX512_INLINE OccupiedWords classify_light(const SpanTables& tables, const RowPixels& row, const Span& span,
                                                     ColorId* colors) {
  const std::uint32_t first = span.begin / kBlock, last = (span.end - 1) / kBlock;
  const OccupiedWords all = bits(first, last + 1);
  typename Layout::Quiet of_row{};
  if constexpr (kOneLight) of_row = Layout::quiet(lights_at<true>(tables, {}));
  OccupiedWords left = is_loud<Layout, kOneLight, false>(tables, row, span.block(first), of_row, colors) << first;
  for (std::uint32_t word = first + 1; word < last; ++word) {
    const Block block = {word * kBlock, 0, kBlock};
    left |= is_loud<Layout, kOneLight, true>(tables, row, block, of_row, colors) << word;
  }
  if (last > first) {
    left |= is_loud<Layout, kOneLight, false>(tables, row, span.block(last), of_row, colors) << last;
  }
  if (!tables.has_quiet) left = all;

  // A row full of colors has little to gain by the second.
  if (2 * std::popcount(left) <= std::popcount(all)) {
    OccupiedWords near = 0;
    for (OccupiedWords among = left; among != 0; among &= among - 1) {
      const auto word = static_cast<std::uint32_t>(std::countr_zero(among));
      const Channels channels = channels_at<Layout, kOneLight>(tables, row, span.block(word));
      near |= OccupiedWords{is_near<kOneLight>(tables, channels)} << word;
    }
    left = near;
  }
  OccupiedWords occupied = 0;
  for (; left != 0; left &= left - 1) {
    const auto word = static_cast<std::uint32_t>(std::countr_zero(left));
    const Block block = span.block(word);
    const __m512i found = colors_of<kOneLight>(tables, channels_at<Layout, kOneLight>(tables, row, block));
    _mm512_mask_storeu_epi8(colors + block.u, block.inside(), found);
    occupied |= OccupiedWords{_mm512_mask_test_epi8_mask(block.inside(), found, found) != 0} << word;
  }
  return occupied;
}

template <PixelFormat, class Layout>
TOUCHLINE_AVX512 OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                             std::uint32_t end, ColorId* colors) {
  if (begin >= end) return 0;
  // Copies: what is written to `colors` cannot change them.
  const SpanTables of_row = tables;
  const RowPixels pixels = row;
  return tables.one_light ? classify_light<Layout, true>(of_row, pixels, {begin, end}, colors)
                          : classify_light<Layout, false>(of_row, pixels, {begin, end}, colors);
}

template <PixelFormat kFormat>
using LayoutOf = std::conditional_t<color_space(kFormat) == ColorSpace::kRgb, Packed24<kFormat>,
                                    std::conditional_t<kFormat == PixelFormat::kNv12, Planar, Packed16<kFormat>>>;
struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<kFormat, LayoutOf<kFormat>>;
};

bool has_avx512() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512vbmi") != 0 &&
         __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("popcnt") != 0;
}

}  // namespace

SpanKernel avx512_kernel(PixelFormat format) {
  return has_avx512() ? kernel_of_format<Family>(format) : nullptr;
}

}  // namespace touchline

#else

namespace touchline {

SpanKernel avx512_kernel(PixelFormat) { return nullptr; }

}  // namespace touchline

#endif
