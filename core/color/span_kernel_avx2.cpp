#include "core/color/span_kernel.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace touchline {
namespace {

// Every function carries the target itself: a file compiled for AVX2 as a whole would leave AVX2 code in functions that
// it shares with other files, and on an older processor the linker may have picked those.
#define TOUCHLINE_AVX2 [[gnu::target("avx2")]]
#define TOUCHLINE_AVX2_INLINE [[gnu::target("avx2"), gnu::always_inline]] inline

// A byte shuffle looks up within 16 bytes: half a register is a tile, which has its own tables.
constexpr std::uint32_t kTile = kTileWidth, kBlock = 2 * kTile;
static_assert(kTile == 16);

TOUCHLINE_AVX2_INLINE __m256i load(const std::uint8_t* bytes) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes));
}
TOUCHLINE_AVX2_INLINE __m128i load_half(const std::uint8_t* bytes) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes));
}
TOUCHLINE_AVX2_INLINE __m256i halves(__m128i low, __m128i high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}
TOUCHLINE_AVX2_INLINE __m256i load_halves(const std::uint8_t* low, const std::uint8_t* high) {
  return halves(load_half(low), load_half(high));
}
TOUCHLINE_AVX2_INLINE __m256i in_both_halves(const std::uint8_t* bytes) {
  return _mm256_broadcastsi128_si256(load_half(bytes));
}
TOUCHLINE_AVX2_INLINE void store(ColorId* colors, __m256i value) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(colors), value);
}
TOUCHLINE_AVX2_INLINE void store_half(ColorId* colors, __m128i value) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(colors), value);
}
TOUCHLINE_AVX2_INLINE bool is_zero(__m256i value) { return _mm256_testz_si256(value, value) != 0; }

// The light of the tiles in the lower and the upper half; the same one where there is but one.
struct Lights {
  const TileLight *low, *high;
};

// Four bytes of each light, over and over in its half.
template <bool kOneLight>
TOUCHLINE_AVX2_INLINE __m256i four_bytes(const std::array<std::uint8_t, 4>& low,
                                         const std::array<std::uint8_t, 4>& high) {
  const __m256i in_low = _mm256_set1_epi32(std::bit_cast<int>(low));
  if constexpr (kOneLight) return in_low;
  return _mm256_blend_epi32(in_low, _mm256_set1_epi32(std::bit_cast<int>(high)), 0b11110000);
}

template <bool kOneLight>
TOUCHLINE_AVX2_INLINE __m256i look_up(const std::array<std::uint8_t, 16>& low, const std::array<std::uint8_t, 16>& high,
                                      __m256i digit) {
  const __m256i table = kOneLight ? in_both_halves(low.data()) : load_halves(low.data(), high.data());
  return _mm256_shuffle_epi8(table, digit);
}

// The hexadecimal digits of 32 values.
struct Digits {
  __m256i high, low;
};
TOUCHLINE_AVX2_INLINE Digits digits_of(__m256i values) {
  const __m256i low_digit = _mm256_set1_epi8(15);
  return {_mm256_and_si256(_mm256_srli_epi16(values, 4), low_digit), _mm256_and_si256(values, low_digit)};
}

// A channel's values in a block, and the tables of each half.
struct Channel {
  Digits value;
  const ChannelDigits *low, *high;
};

// The group's classes whose intervals' high digits include those of the values.
template <bool kOneLight>
TOUCHLINE_AVX2_INLINE __m256i near_classes(const Channel& channel, std::size_t group) {
  return look_up<kOneLight>((*channel.low)[group].within, (*channel.high)[group].within, channel.value.high);
}
// The group's classes to which the values of a channel belong, a byte a value, out of the near ones.
template <bool kOneLight>
TOUCHLINE_AVX2_INLINE __m256i classes_of(const Channel& channel, std::size_t group, __m256i near) {
  const DigitTables &low = (*channel.low)[group], &high = (*channel.high)[group];
  const Digits& value = channel.value;
  const __m256i from = _mm256_or_si256(look_up<kOneLight>(low.above_first, high.above_first, value.high),
                                       look_up<kOneLight>(low.from_first, high.from_first, value.low));
  const __m256i to = _mm256_or_si256(look_up<kOneLight>(low.below_last, high.below_last, value.high),
                                     look_up<kOneLight>(low.to_last, high.to_last, value.low));
  return _mm256_and_si256(near, _mm256_and_si256(from, to));
}

// The color of the lowest class; where an earlier group has given a color, that.
TOUCHLINE_AVX2_INLINE __m256i add_colors(__m256i colors, const ColorDigits& tables, __m256i classes) {
  const Digits bits = digits_of(classes);
  const __m256i zero = _mm256_setzero_si256();
  const __m256i low = look_up<true>(tables.low, tables.low, bits.low);
  const __m256i high = look_up<true>(tables.high, tables.high, bits.high);
  const __m256i color = _mm256_blendv_epi8(low, high, _mm256_cmpeq_epi8(low, zero));
  return _mm256_blendv_epi8(colors, color, _mm256_cmpeq_epi8(colors, zero));
}

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
  __m256i channel[3];
};

// The layouts below say of a block whose halves begin at any two columns, of shared chroma even ones,
// - loud: whether it is not wholly in the quiet box,
// - planes: its three channels, chroma doubled.

// Three bytes a pixel.
template <PixelFormat kFormat>
struct Packed24 {
  static constexpr bool kPairs = false;
  static constexpr std::array kPick = {pick_bytes(kFormat == PixelFormat::kRgb24 ? 0 : 2, 3, 1), pick_bytes(1, 3, 1),
                                       pick_bytes(kFormat == PixelFormat::kRgb24 ? 2 : 0, 3, 1)};

  // Three bytes over and over, from byte i % 3 on.
  static constexpr auto kPeriod = [] {
    std::array<std::array<std::uint8_t, 16>, 3> period{};
    for (std::size_t first = 0; first < 3; ++first) {
      for (std::size_t i = 0; i < 16; ++i) period[first][i] = static_cast<std::uint8_t>((first + i) % 3);
    }
    return period;
  }();

  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static bool loud(const RowPixels& row, std::uint32_t u, const Lights& lights) {
    const __m256i reach = four_bytes<kOneLight>(lights.low->quiet_reach, lights.high->quiet_reach);
    const std::uint8_t *low = row.samples + std::size_t{3} * u, *high = low + std::size_t{3} * kTile;
    __m256i beyond_reach = _mm256_setzero_si256();
    for (std::size_t piece = 0; piece < 3; ++piece) {
      const __m256i bytes = load_halves(low + 16 * piece, high + 16 * piece);
      const __m256i of_bytes = _mm256_shuffle_epi8(reach, in_both_halves(kPeriod[piece].data()));
      // Quiet values begin at 0.
      beyond_reach = _mm256_or_si256(beyond_reach, _mm256_subs_epu8(bytes, of_bytes));
    }
    return !is_zero(beyond_reach);
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u_low, std::uint32_t u_high) {
    const std::uint8_t *low = row.samples + std::size_t{3} * u_low, *high = row.samples + std::size_t{3} * u_high;
    const __m256i first = load_halves(low, high), second = load_halves(low + 16, high + 16),
                  third = load_halves(low + 32, high + 32);
    Planes planes;
    for (std::size_t c = 0; c < 3; ++c) {
      planes.channel[c] =
          _mm256_or_si256(_mm256_shuffle_epi8(first, in_both_halves(kPick[c][0].data())),
                          _mm256_or_si256(_mm256_shuffle_epi8(second, in_both_halves(kPick[c][1].data())),
                                          _mm256_shuffle_epi8(third, in_both_halves(kPick[c][2].data()))));
    }
    return planes;
  }
};

// Two bytes a pixel.
template <PixelFormat kFormat>
struct Packed16 {
  static constexpr bool kPairs = true;
  static constexpr std::size_t kLumaAt = kFormat == PixelFormat::kYuyv ? 0 : 1, kChromaAt = 1 - kLumaAt;
  static constexpr std::array kPick = {pick_bytes(kLumaAt, 2, 1), pick_bytes(kChromaAt, 4, 2),
                                       pick_bytes(kChromaAt + 2, 4, 2)};

  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static bool loud(const RowPixels& row, std::uint32_t u, const Lights& lights) {
    const std::uint8_t* bytes = row.samples + std::size_t{2} * u;
    return !is_zero(
        _mm256_or_si256(loud_of(bytes, *lights.low), loud_of(bytes + std::size_t{2} * kTile, *lights.high)));
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud_of(const std::uint8_t* tile, const TileLight& light) {
    return beyond(load(tile), four_bytes<true>(light.quiet_low, light.quiet_low),
                  four_bytes<true>(light.quiet_reach, light.quiet_reach));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u_low, std::uint32_t u_high) {
    const std::uint8_t *low = row.samples + std::size_t{2} * u_low, *high = row.samples + std::size_t{2} * u_high;
    const __m256i first = load_halves(low, high), second = load_halves(low + 16, high + 16);
    Planes planes;
    for (std::size_t c = 0; c < 3; ++c) {
      planes.channel[c] = _mm256_or_si256(_mm256_shuffle_epi8(first, in_both_halves(kPick[c][0].data())),
                                          _mm256_shuffle_epi8(second, in_both_halves(kPick[c][1].data())));
    }
    return planes;
  }
};

// A byte a pixel, and two a pair.
struct Planar {
  static constexpr bool kPairs = true;
  static constexpr std::array kPick = {pick_bytes(0, 2, 2), pick_bytes(1, 2, 2)};

  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static bool loud(const RowPixels& row, std::uint32_t u, const Lights& lights) {
    const __m256i low = four_bytes<kOneLight>(lights.low->quiet_low, lights.high->quiet_low),
                  reach = four_bytes<kOneLight>(lights.low->quiet_reach, lights.high->quiet_reach);
    const __m256i of_luma = _mm256_setzero_si256();
    const __m256i of_chroma = _mm256_set1_epi16(0x0302);
    return !is_zero(_mm256_or_si256(
        beyond(load(row.samples + u), _mm256_shuffle_epi8(low, of_luma), _mm256_shuffle_epi8(reach, of_luma)),
        beyond(load(row.chroma + u), _mm256_shuffle_epi8(low, of_chroma), _mm256_shuffle_epi8(reach, of_chroma))));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u_low, std::uint32_t u_high) {
    const __m256i chroma = load_halves(row.chroma + u_low, row.chroma + u_high);
    return {{load_halves(row.samples + u_low, row.samples + u_high),
             _mm256_shuffle_epi8(chroma, in_both_halves(kPick[0][0].data())),
             _mm256_shuffle_epi8(chroma, in_both_halves(kPick[1][0].data()))}};
  }
};

TOUCHLINE_AVX2_INLINE Channel channel_of(const SpanTables& tables, const Planes& planes, const Lights& lights,
                                         std::size_t c) {
  return {digits_of(planes.channel[c]), &tables.digits->channel(c, lights.low->level[c]),
          &tables.digits->channel(c, lights.high->level[c])};
}

template <bool kOneLight>
TOUCHLINE_AVX2_INLINE __m256i colors_of(const SpanTables& tables, const Planes& planes, const Lights& lights) {
  const Channel first = channel_of(tables, planes, lights, 0), second = channel_of(tables, planes, lights, 1),
                third = channel_of(tables, planes, lights, 2);
  __m256i colors = _mm256_setzero_si256();
  for (std::size_t group = 0; group < tables.digits->groups(); ++group) {
    // Most blocks are background by their high digits.
    const __m256i near = _mm256_and_si256(
        near_classes<kOneLight>(first, group),
        _mm256_and_si256(near_classes<kOneLight>(second, group), near_classes<kOneLight>(third, group)));
    if (is_zero(near)) continue;
    const __m256i classes = _mm256_and_si256(
        classes_of<kOneLight>(first, group, near),
        _mm256_and_si256(classes_of<kOneLight>(second, group, near), classes_of<kOneLight>(third, group, near)));
    colors = add_colors(colors, tables.digits->colors()[group], classes);
  }
  return colors;
}

TOUCHLINE_AVX2_INLINE OccupiedWords occupied_at(std::uint32_t u, __m256i colors) {
  return OccupiedWords{!is_zero(colors)} << u / kOccupiedWordPixels;
}

// Whole tiles, at least one. First all blocks are looked at without a branch that depends on what is there, so that no
// wrong guess delays the processor, then those that are not quiet are classified.
template <class Layout, bool kOneLight>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_tiles(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                   std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  const auto lights_at = [&](std::uint32_t u_low, std::uint32_t u_high) {
    return Lights{&tables.tile_at(u_low), &tables.tile_at(u_high)};
  };
  if (end - begin < kBlock) {
    const __m256i found = colors_of<kOneLight>(tables, Layout::planes(row, begin, begin), lights_at(begin, begin));
    store_half(colors + begin, _mm256_castsi256_si128(found));
    return occupied_at(begin, found);
  }
  constexpr std::uint32_t kMostBlocks = 64;
  for (std::uint32_t first = begin; first < end; first += kMostBlocks * kBlock) {
    const std::uint32_t count = std::min(kMostBlocks, (end - first + kBlock - 1) / kBlock);
    // The last block overlaps the one before it.
    const auto column = [&](std::uint32_t i) { return std::min(first + i * kBlock, end - kBlock); };
    std::uint64_t loud = tables.has_quiet ? 0 : ~std::uint64_t{0} >> (kMostBlocks - count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t u = column(i);
      store(colors + u, _mm256_setzero_si256());
      if (tables.has_quiet) {
        loud |= std::uint64_t{Layout::template loud<kOneLight>(row, u, lights_at(u, u + kTile))} << i;
      }
    }
    for (; loud != 0; loud &= loud - 1) {
      const std::uint32_t u = column(static_cast<std::uint32_t>(std::countr_zero(loud)));
      const __m256i found = colors_of<kOneLight>(tables, Layout::planes(row, u, u + kTile), lights_at(u, u + kTile));
      store(colors + u, found);
      occupied |= occupied_at(u, found) | occupied_at(u + kTile, found);
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
  const __m256i found = colors_of<kOneLight>(tables, Layout::planes(row, begin, last),
                                             {&tables.tile_at(begin), &tables.tile_at(end - 1)});
  const __m128i place = _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m128i first_colors =
      _mm_and_si128(_mm256_castsi256_si128(found), _mm_cmplt_epi8(place, _mm_set1_epi8(of_first)));
  const __m128i last_colors =
      _mm_andnot_si128(_mm_cmplt_epi8(place, _mm_set1_epi8(before_last)), _mm256_extracti128_si256(found, 1));
  // The two may overlap each other.
  store_half(colors + last, _mm_setzero_si128());
  store_half(colors + begin, first_colors);
  store_half(colors + last, _mm_or_si128(load_half(colors + last), last_colors));
  return occupied_at(begin, _mm256_zextsi128_si256(first_colors)) |
         occupied_at(end - 1, _mm256_zextsi128_si256(last_colors));
}

template <class Layout, PixelFormat kFormat, bool kOneLight>
TOUCHLINE_AVX2 OccupiedWords classify_light(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                            std::uint32_t end, ColorId* colors) {
  if (end - begin < kTile) return scalar_kernel(kFormat)(tables, row, begin, end, colors);
  OccupiedWords occupied = 0;
  if (begin % kTile != 0 || end % kTile != 0)
    occupied |= classify_ends<Layout, kOneLight>(tables, row, begin, end, colors);
  const std::uint32_t first = (begin + kTile - 1) / kTile * kTile, stop = end / kTile * kTile;
  if (first < stop) occupied |= classify_tiles<Layout, kOneLight>(tables, row, first, stop, colors);
  return occupied;
}

template <class Layout, PixelFormat kFormat>
TOUCHLINE_AVX2 OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                           std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  if constexpr (Layout::kPairs) {
    // Only whole pairs go into blocks.
    const SpanKernel one_by_one = scalar_kernel(kFormat);
    if (begin % 2 == 1 && begin < end) occupied |= one_by_one(tables, row, begin, begin + 1, colors), ++begin;
    if (end % 2 == 1 && begin < end) occupied |= one_by_one(tables, row, end - 1, end, colors), --end;
  }
  if (begin >= end) return occupied;
  return occupied | (tables.one_light ? classify_light<Layout, kFormat, true>(tables, row, begin, end, colors)
                                      : classify_light<Layout, kFormat, false>(tables, row, begin, end, colors));
}

}  // namespace

SpanKernel avx2_kernel(PixelFormat format) {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") == 0) return nullptr;
  switch (format) {
    case PixelFormat::kRgb24:
      return classify_span<Packed24<PixelFormat::kRgb24>, PixelFormat::kRgb24>;
    case PixelFormat::kBgr24:
      return classify_span<Packed24<PixelFormat::kBgr24>, PixelFormat::kBgr24>;
    case PixelFormat::kYuyv:
      return classify_span<Packed16<PixelFormat::kYuyv>, PixelFormat::kYuyv>;
    case PixelFormat::kUyvy:
      return classify_span<Packed16<PixelFormat::kUyvy>, PixelFormat::kUyvy>;
    case PixelFormat::kNv12:
      return classify_span<Planar, PixelFormat::kNv12>;
  }
  return nullptr;
}

}  // namespace touchline

#else

namespace touchline {

SpanKernel avx2_kernel(PixelFormat) { return nullptr; }

}  // namespace touchline

#endif
