#pragma once

#include "core/color/digit_lookup_avx2.h"

#if defined(__x86_64__)

#include <type_traits>

// Where the AVX2 kernel finds a format's channels, and which of its bytes are not quiet.
namespace touchline::TOUCHLINE_AVX2_NAMESPACE {

// Which bytes are farther above `low` than `reach`: those are not zero.
TOUCHLINE_AVX2_INLINE __m256i beyond(__m256i bytes, __m256i low, __m256i reach) {
  return _mm256_subs_epu8(_mm256_sub_epi8(bytes, low), reach);
}

// A byte shuffle's pattern that takes byte first + step * (i / repeat) of two times 16 as byte i; what is not in this
// 16 is 128, which gives zero.
using Pick = std::array<std::array<std::uint8_t, 16>, 3>;
constexpr Pick pick_bytes(std::size_t first, std::size_t step, std::size_t repeat) {
  Pick pick{};
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

// A tile for each half of a register.
struct TwoTiles {
  std::uint32_t u_low, u_high;
  const TileLight *light_low, *light_high;
};
// quiet_low and quiet_reach, eight bytes over and over; those of each tile in its half.
TOUCHLINE_AVX2_INLINE __m256i quiet_bytes_of(const TileLight& light) {
  static_assert(offsetof(TileLight, quiet_reach) == offsetof(TileLight, quiet_low) + 4);
  return _mm256_broadcastq_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(light.quiet_low.data())));
}
TOUCHLINE_AVX2_INLINE __m256i quiet_bytes_of(const TwoTiles& tiles) {
  return _mm256_blend_epi32(quiet_bytes_of(*tiles.light_low), quiet_bytes_of(*tiles.light_high), 0b11110000);
}

// The layouts below give
// - loud: bytes that are not zero unless all of a block is in the quiet box of one light; or, of two tiles that begin
// at
//   any columns, those of a tile in each half, each in the quiet box of its own light,
// - planes: the three channels of a block, chroma doubled,
// - tile_planes: the same of a tile, in both halves.
// With shared chroma all begin at even columns.

// Of three bytes a pixel; of luma and of chroma in four bytes a pair; of chroma in two bytes a pair.
inline constexpr std::array kOfThree = {pick_bytes(0, 3, 1), pick_bytes(1, 3, 1), pick_bytes(2, 3, 1)};
inline constexpr std::array kLumaOfFour = {pick_bytes(0, 2, 1), pick_bytes(1, 2, 1)};
inline constexpr std::array kChromaOfFour = {pick_bytes(0, 4, 2), pick_bytes(1, 4, 2), pick_bytes(2, 4, 2),
                                             pick_bytes(3, 4, 2)};
inline constexpr std::array kChromaOfTwo = {pick_bytes(0, 2, 2), pick_bytes(1, 2, 2)};

TOUCHLINE_AVX2_INLINE __m256i picked(__m256i first, const Pick& pick) {
  return _mm256_shuffle_epi8(first, in_both_halves(pick[0].data()));
}
TOUCHLINE_AVX2_INLINE __m256i picked(__m256i first, __m256i second, const Pick& pick) {
  return _mm256_or_si256(picked(first, pick), _mm256_shuffle_epi8(second, in_both_halves(pick[1].data())));
}
TOUCHLINE_AVX2_INLINE __m256i picked(__m256i first, __m256i second, __m256i third, const Pick& pick) {
  return _mm256_or_si256(picked(first, second, pick), _mm256_shuffle_epi8(third, in_both_halves(pick[2].data())));
}

// Three bytes over and over.
inline constexpr auto kPeriod = [] {
  std::array<std::uint8_t, 96> period{};
  for (std::size_t i = 0; i < period.size(); ++i) period[i] = static_cast<std::uint8_t>(i % 3);
  return period;
}();

// Three bytes a pixel.
template <PixelFormat kFormat>
struct Packed24 {
  struct Quiet {
    __m256i low[3], reach[3];
  };
  // `at`: where in each half of the light its 32 bytes begin.
  TOUCHLINE_AVX2_INLINE static Quiet spread(__m256i light, const Planes& at) {
    const __m256i reach = _mm256_set1_epi8(4);
    return {{_mm256_shuffle_epi8(light, at.first), _mm256_shuffle_epi8(light, at.second),
             _mm256_shuffle_epi8(light, at.third)},
            {_mm256_shuffle_epi8(light, _mm256_add_epi8(at.first, reach)),
             _mm256_shuffle_epi8(light, _mm256_add_epi8(at.second, reach)),
             _mm256_shuffle_epi8(light, _mm256_add_epi8(at.third, reach))}};
  }
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const TileLight& light) {
    return spread(quiet_bytes_of(light), {load(&kPeriod[0]), load(&kPeriod[32]), load(&kPeriod[64])});
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    const std::uint8_t* bytes = row.samples + std::size_t{3} * u;
    return beyond(load(bytes), load(bytes + 32), load(bytes + 64), quiet);
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, const TwoTiles& tiles) {
    const std::uint8_t *low = row.samples + std::size_t{3} * tiles.u_low,
                       *high = row.samples + std::size_t{3} * tiles.u_high;
    return beyond(load_halves(low, high), load_halves(low + 16, high + 16), load_halves(low + 32, high + 32),
                  spread(quiet_bytes_of(tiles),
                         {in_both_halves(&kPeriod[0]), in_both_halves(&kPeriod[16]), in_both_halves(&kPeriod[32])}));
  }
  TOUCHLINE_AVX2_INLINE static __m256i beyond(__m256i first, __m256i second, __m256i third, const Quiet& quiet) {
    return _mm256_or_si256(TOUCHLINE_AVX2_NAMESPACE::beyond(first, quiet.low[0], quiet.reach[0]),
                           _mm256_or_si256(TOUCHLINE_AVX2_NAMESPACE::beyond(second, quiet.low[1], quiet.reach[1]),
                                           TOUCHLINE_AVX2_NAMESPACE::beyond(third, quiet.low[2], quiet.reach[2])));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t *low = row.samples + std::size_t{3} * u, *high = low + 48;
    return planes(load_halves(low, high), load_halves(low + 16, high + 16), load_halves(low + 32, high + 32));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t* bytes = row.samples + std::size_t{3} * u;
    return planes(in_both_halves(bytes), in_both_halves(bytes + 16), in_both_halves(bytes + 32));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(__m256i first, __m256i second, __m256i third) {
    constexpr std::size_t kRed = kFormat == PixelFormat::kRgb24 ? 0 : 2;
    return {picked(first, second, third, kOfThree[kRed]), picked(first, second, third, kOfThree[1]),
            picked(first, second, third, kOfThree[2 - kRed])};
  }
};

// Two bytes a pixel.
template <PixelFormat kFormat>
struct Packed16 {
  struct Quiet {
    __m256i low, reach;
  };
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const TileLight& light) { return quiet(quiet_bytes_of(light)); }
  TOUCHLINE_AVX2_INLINE static Quiet quiet(__m256i bytes) {
    return {_mm256_shuffle_epi32(bytes, 0b00000000), _mm256_shuffle_epi32(bytes, 0b01010101)};
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    const std::uint8_t* bytes = row.samples + std::size_t{2} * u;
    return _mm256_or_si256(beyond(load(bytes), quiet.low, quiet.reach),
                           beyond(load(bytes + 32), quiet.low, quiet.reach));
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, const TwoTiles& tiles) {
    const std::uint8_t *low = row.samples + std::size_t{2} * tiles.u_low,
                       *high = row.samples + std::size_t{2} * tiles.u_high;
    const Quiet of_tiles = quiet(quiet_bytes_of(tiles));
    return _mm256_or_si256(beyond(load_halves(low, high), of_tiles.low, of_tiles.reach),
                           beyond(load_halves(low + 16, high + 16), of_tiles.low, of_tiles.reach));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t *low = row.samples + std::size_t{2} * u, *high = low + 32;
    return planes(load_halves(low, high), load_halves(low + 16, high + 16));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t* bytes = row.samples + std::size_t{2} * u;
    return planes(in_both_halves(bytes), in_both_halves(bytes + 16));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(__m256i first, __m256i second) {
    constexpr std::size_t kLuma = kFormat == PixelFormat::kYuyv ? 0 : 1, kChroma = 1 - kLuma;
    return {picked(first, second, kLumaOfFour[kLuma]), picked(first, second, kChromaOfFour[kChroma]),
            picked(first, second, kChromaOfFour[kChroma + 2])};
  }
};

// A byte a pixel, and two a pair.
struct Planar {
  struct Quiet {
    __m256i luma_low, luma_reach, chroma_low, chroma_reach;
  };
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const TileLight& light) { return quiet(quiet_bytes_of(light)); }
  TOUCHLINE_AVX2_INLINE static Quiet quiet(__m256i bytes) {
    return {_mm256_shuffle_epi8(bytes, _mm256_set1_epi8(0)), _mm256_shuffle_epi8(bytes, _mm256_set1_epi8(4)),
            _mm256_shuffle_epi8(bytes, _mm256_set1_epi16(0x0302)),
            _mm256_shuffle_epi8(bytes, _mm256_set1_epi16(0x0706))};
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    return loud(load(row.samples + u), load(row.chroma + u), quiet);
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, const TwoTiles& tiles) {
    return loud(load_halves(row.samples + tiles.u_low, row.samples + tiles.u_high),
                load_halves(row.chroma + tiles.u_low, row.chroma + tiles.u_high), quiet(quiet_bytes_of(tiles)));
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(__m256i luma, __m256i chroma, const Quiet& quiet) {
    return _mm256_or_si256(beyond(luma, quiet.luma_low, quiet.luma_reach),
                           beyond(chroma, quiet.chroma_low, quiet.chroma_reach));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    return planes(load(row.samples + u), load(row.chroma + u));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    return planes(in_both_halves(row.samples + u), in_both_halves(row.chroma + u));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(__m256i luma, __m256i chroma) {
    return {luma, picked(chroma, kChromaOfTwo[0]), picked(chroma, kChromaOfTwo[1])};
  }
};

template <PixelFormat kFormat>
using LayoutOf = std::conditional_t<color_space(kFormat) == ColorSpace::kRgb, Packed24<kFormat>,
                                    std::conditional_t<kFormat == PixelFormat::kNv12, Planar, Packed16<kFormat>>>;

}  // namespace touchline::TOUCHLINE_AVX2_NAMESPACE

#endif
