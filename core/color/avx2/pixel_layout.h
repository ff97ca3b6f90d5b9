#pragma once

#include "core/color/avx2/nibble_lookup.h"

#if defined(__x86_64__)

#include <type_traits>

// Memory layouts of the pixel formats: extraction of the channels, and the test against the background box.
namespace touchline::avx2 {

// Returns bytes that are nonzero where a value is outside low..low + extent.
TOUCHLINE_AVX2_INLINE __m256i beyond(__m256i bytes, __m256i low, __m256i extent) {
  return _mm256_subs_epu8(_mm256_sub_epi8(bytes, low), extent);
}

// Shuffle patterns that move byte first + step * (i / repeat) to byte i, one pattern for each 16 source bytes. An entry
// is 128, which gives zero, if its byte lies in another 16 source bytes.
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

// Two tiles, one for each half of a register.
struct TwoTiles {
  std::uint32_t u_low, u_high;
  const TileParameters *light_low, *light_high;
};
// Repeats the eight bytes of background_low and background_extent; with two tiles, each in its half.
TOUCHLINE_AVX2_INLINE __m256i background_bytes_of(const TileParameters& light) {
  static_assert(offsetof(TileParameters, background_extent) == offsetof(TileParameters, background_low) + 4);
  return _mm256_broadcastq_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(light.background_low.data())));
}
TOUCHLINE_AVX2_INLINE __m256i background_bytes_of(const TwoTiles& tiles) {
  return _mm256_blend_epi32(background_bytes_of(*tiles.light_low), background_bytes_of(*tiles.light_high), 0b11110000);
}

// Each layout below has these functions:
// - candidates: returns zero only if all pixels are in the background box. Its argument is either a block, which has
//   the level of background(), or two tiles that begin at any columns. The two tiles either both have the level of
//   background_of_tiles(), or each has its own level; each half of the result belongs to one tile.
// - planes: returns the three channels of a block or of two tiles, with chroma repeated for both pixels of a pair.
// - tile_planes: returns the three channels of one tile, in both halves.
// With shared chroma, tiles begin at even columns.

// Patterns for three bytes per pixel, for luma and chroma in four bytes per pair, and for chroma in two bytes per pair.
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

// 0, 1, 2, repeated.
inline constexpr auto kPeriod = [] {
  std::array<std::uint8_t, 96> period{};
  for (std::size_t i = 0; i < period.size(); ++i) period[i] = static_cast<std::uint8_t>(i % 3);
  return period;
}();

// Three bytes per pixel.
template <PixelFormat kFormat>
struct Packed24 {
  struct Background {
    __m256i low[3], extent[3];
  };
  // `at` tells for each byte which of the three bytes of the light belongs to it.
  TOUCHLINE_AVX2_INLINE static Background spread(__m256i light, const Planes& at) {
    const __m256i extent = _mm256_set1_epi8(4);
    return {{_mm256_shuffle_epi8(light, at.first), _mm256_shuffle_epi8(light, at.second),
             _mm256_shuffle_epi8(light, at.third)},
            {_mm256_shuffle_epi8(light, _mm256_add_epi8(at.first, extent)),
             _mm256_shuffle_epi8(light, _mm256_add_epi8(at.second, extent)),
             _mm256_shuffle_epi8(light, _mm256_add_epi8(at.third, extent))}};
  }
  TOUCHLINE_AVX2_INLINE static Background background(const TileParameters& light) {
    return spread(background_bytes_of(light), {load(&kPeriod[0]), load(&kPeriod[32]), load(&kPeriod[64])});
  }
  TOUCHLINE_AVX2_INLINE static Background background_of_tiles(const TileParameters& light) {
    return spread(background_bytes_of(light),
                  {in_both_halves(&kPeriod[0]), in_both_halves(&kPeriod[16]), in_both_halves(&kPeriod[32])});
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, const Background& background) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{3} * u;
    return beyond(load(bytes), load(bytes + 32), load(bytes + 64), background);
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, std::uint32_t v,
                                                  const Background& background) {
    const std::uint8_t *low = row.plane[0] + std::size_t{3} * u, *high = row.plane[0] + std::size_t{3} * v;
    return beyond(load_halves(low, high), load_halves(low + 16, high + 16), load_halves(low + 32, high + 32),
                  background);
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, const TwoTiles& tiles) {
    const std::uint8_t *low = row.plane[0] + std::size_t{3} * tiles.u_low,
                       *high = row.plane[0] + std::size_t{3} * tiles.u_high;
    return beyond(load_halves(low, high), load_halves(low + 16, high + 16), load_halves(low + 32, high + 32),
                  spread(background_bytes_of(tiles),
                         {in_both_halves(&kPeriod[0]), in_both_halves(&kPeriod[16]), in_both_halves(&kPeriod[32])}));
  }
  TOUCHLINE_AVX2_INLINE static __m256i beyond(__m256i first, __m256i second, __m256i third,
                                              const Background& background) {
    return _mm256_or_si256(avx2::beyond(first, background.low[0], background.extent[0]),
                           _mm256_or_si256(avx2::beyond(second, background.low[1], background.extent[1]),
                                           avx2::beyond(third, background.low[2], background.extent[2])));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    return planes(row, u, u + kTile);
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u, std::uint32_t v) {
    const std::uint8_t *low = row.plane[0] + std::size_t{3} * u, *high = row.plane[0] + std::size_t{3} * v;
    return planes(load_halves(low, high), load_halves(low + 16, high + 16), load_halves(low + 32, high + 32));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{3} * u;
    return planes(in_both_halves(bytes), in_both_halves(bytes + 16), in_both_halves(bytes + 32));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(__m256i first, __m256i second, __m256i third) {
    constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
    return {picked(first, second, third, kOfThree[kRed]), picked(first, second, third, kOfThree[1]),
            picked(first, second, third, kOfThree[2 - kRed])};
  }
};

// Formats whose channels repeat after four bytes.
struct PeriodOfFour {
  struct Background {
    __m256i low, extent;
  };
  TOUCHLINE_AVX2_INLINE static Background background(const TileParameters& light) {
    return background(background_bytes_of(light));
  }
  TOUCHLINE_AVX2_INLINE static Background background(__m256i bytes) {
    return {_mm256_shuffle_epi32(bytes, 0b00000000), _mm256_shuffle_epi32(bytes, 0b01010101)};
  }
  TOUCHLINE_AVX2_INLINE static Background background_of_tiles(const TileParameters& light) { return background(light); }
};

// Two bytes per pixel.
template <PixelFormat kFormat>
struct Packed16 : PeriodOfFour {
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, const Background& background) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{2} * u;
    return _mm256_or_si256(beyond(load(bytes), background.low, background.extent),
                           beyond(load(bytes + 32), background.low, background.extent));
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, std::uint32_t v,
                                                  const Background& background) {
    const std::uint8_t *low = row.plane[0] + std::size_t{2} * u, *high = row.plane[0] + std::size_t{2} * v;
    return _mm256_or_si256(beyond(load_halves(low, high), background.low, background.extent),
                           beyond(load_halves(low + 16, high + 16), background.low, background.extent));
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, const TwoTiles& tiles) {
    const std::uint8_t *low = row.plane[0] + std::size_t{2} * tiles.u_low,
                       *high = row.plane[0] + std::size_t{2} * tiles.u_high;
    const Background of_tiles = background(background_bytes_of(tiles));
    return _mm256_or_si256(beyond(load_halves(low, high), of_tiles.low, of_tiles.extent),
                           beyond(load_halves(low + 16, high + 16), of_tiles.low, of_tiles.extent));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    return planes(row, u, u + kTile);
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u, std::uint32_t v) {
    const std::uint8_t *low = row.plane[0] + std::size_t{2} * u, *high = row.plane[0] + std::size_t{2} * v;
    return planes(load_halves(low, high), load_halves(low + 16, high + 16));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{2} * u;
    return planes(in_both_halves(bytes), in_both_halves(bytes + 16));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(__m256i first, __m256i second) {
    constexpr std::size_t kLuma = info_of(kFormat).channel[0].offset, kChroma = 1 - kLuma;
    return {picked(first, second, kLumaOfFour[kLuma]), picked(first, second, kChromaOfFour[kChroma]),
            picked(first, second, kChromaOfFour[kChroma + 2])};
  }
};

// Four bytes per pixel, the last of them unused.
template <PixelFormat kFormat>
struct Packed32 : PeriodOfFour {
  struct Bytes {
    __m256i first, second, third, fourth;
  };
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const Bytes& bytes, const Background& background) {
    const __m256i low = background.low, extent = background.extent;
    return _mm256_or_si256(_mm256_or_si256(beyond(bytes.first, low, extent), beyond(bytes.second, low, extent)),
                           _mm256_or_si256(beyond(bytes.third, low, extent), beyond(bytes.fourth, low, extent)));
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, const Background& background) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{4} * u;
    return candidates({load(bytes), load(bytes + 32), load(bytes + 64), load(bytes + 96)}, background);
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, std::uint32_t v,
                                                  const Background& background) {
    return candidates(two_tiles(row.plane[0] + std::size_t{4} * u, row.plane[0] + std::size_t{4} * v), background);
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, const TwoTiles& tiles) {
    return candidates(
        two_tiles(row.plane[0] + std::size_t{4} * tiles.u_low, row.plane[0] + std::size_t{4} * tiles.u_high),
        background(background_bytes_of(tiles)));
  }

  TOUCHLINE_AVX2_INLINE static Bytes two_tiles(const std::uint8_t* low, const std::uint8_t* high) {
    return {load_halves(low, high), load_halves(low + 16, high + 16), load_halves(low + 32, high + 32),
            load_halves(low + 48, high + 48)};
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    return planes(row, u, u + kTile);
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u, std::uint32_t v) {
    return planes(two_tiles(row.plane[0] + std::size_t{4} * u, row.plane[0] + std::size_t{4} * v));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{4} * u;
    return planes(
        {in_both_halves(bytes), in_both_halves(bytes + 16), in_both_halves(bytes + 32), in_both_halves(bytes + 48)});
  }
  // Each half holds a tile. Sorts bytes by channel: within four pixels, then eight, then all 16.
  TOUCHLINE_AVX2_INLINE static Planes planes(const Bytes& bytes) {
    constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
    const __m256i by_channel = _mm256_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15,  //
                                                0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
    const __m256i a = _mm256_shuffle_epi8(bytes.first, by_channel), b = _mm256_shuffle_epi8(bytes.second, by_channel),
                  c = _mm256_shuffle_epi8(bytes.third, by_channel), d = _mm256_shuffle_epi8(bytes.fourth, by_channel);
    const __m256i ab = _mm256_unpacklo_epi32(a, b), cd = _mm256_unpacklo_epi32(c, d);
    const __m256i zeroth = _mm256_unpacklo_epi64(ab, cd), first = _mm256_unpackhi_epi64(ab, cd),
                  second = _mm256_unpacklo_epi64(_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, d));
    return kRed == 0 ? Planes{zeroth, first, second} : Planes{second, first, zeroth};
  }
};

// One luma byte per pixel and two chroma bytes per pair, in one chroma plane or in two.
template <PixelFormat kFormat>
struct Planar {
  static constexpr bool kSeparateUv = info_of(kFormat).packing == Packing::kPlanar;

  // Return U and V interleaved, for a tile, a block and two tiles.
  TOUCHLINE_AVX2_INLINE static __m128i tile_chroma(const RowPixels& row, std::uint32_t u) {
    if constexpr (!kSeparateUv) return load_half(row.plane[1] + u);
    return _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(row.plane[1] + u / 2)),
                             _mm_loadl_epi64(reinterpret_cast<const __m128i*>(row.plane[2] + u / 2)));
  }
  TOUCHLINE_AVX2_INLINE static __m256i chroma(const RowPixels& row, std::uint32_t u) {
    if constexpr (!kSeparateUv) return load(row.plane[1] + u);
    const __m128i first = load_half(row.plane[1] + u / 2), second = load_half(row.plane[2] + u / 2);
    return halves(_mm_unpacklo_epi8(first, second), _mm_unpackhi_epi8(first, second));
  }
  TOUCHLINE_AVX2_INLINE static __m256i chroma(const RowPixels& row, std::uint32_t u, std::uint32_t v) {
    return halves(tile_chroma(row, u), tile_chroma(row, v));
  }

  struct Background {
    __m256i luma_low, luma_extent, chroma_low, chroma_extent;
  };
  TOUCHLINE_AVX2_INLINE static Background background(const TileParameters& light) {
    return background(background_bytes_of(light));
  }
  TOUCHLINE_AVX2_INLINE static Background background_of_tiles(const TileParameters& light) { return background(light); }
  TOUCHLINE_AVX2_INLINE static Background background(__m256i bytes) {
    return {_mm256_shuffle_epi8(bytes, _mm256_set1_epi8(0)), _mm256_shuffle_epi8(bytes, _mm256_set1_epi8(4)),
            _mm256_shuffle_epi8(bytes, _mm256_set1_epi16(0x0302)),
            _mm256_shuffle_epi8(bytes, _mm256_set1_epi16(0x0706))};
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, const Background& background) {
    return candidates(load(row.plane[0] + u), chroma(row, u), background);
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, std::uint32_t u, std::uint32_t v,
                                                  const Background& background) {
    return candidates(load_halves(row.plane[0] + u, row.plane[0] + v), chroma(row, u, v), background);
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(const RowPixels& row, const TwoTiles& tiles) {
    return candidates(load_halves(row.plane[0] + tiles.u_low, row.plane[0] + tiles.u_high),
                      chroma(row, tiles.u_low, tiles.u_high), background(background_bytes_of(tiles)));
  }
  TOUCHLINE_AVX2_INLINE static __m256i candidates(__m256i luma, __m256i chroma, const Background& background) {
    return _mm256_or_si256(beyond(luma, background.luma_low, background.luma_extent),
                           beyond(chroma, background.chroma_low, background.chroma_extent));
  }

  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u) {
    return planes(load(row.plane[0] + u), chroma(row, u));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(const RowPixels& row, std::uint32_t u, std::uint32_t v) {
    return planes(load_halves(row.plane[0] + u, row.plane[0] + v), chroma(row, u, v));
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    return planes(in_both_halves(row.plane[0] + u), _mm256_broadcastsi128_si256(tile_chroma(row, u)));
  }
  TOUCHLINE_AVX2_INLINE static Planes planes(__m256i luma, __m256i chroma) {
    return {luma, picked(chroma, kChromaOfTwo[0]), picked(chroma, kChromaOfTwo[1])};
  }
};

template <PixelFormat kFormat, Packing kPacking = info_of(kFormat).packing>
struct LayoutOf;
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kPacked24> : Packed24<kFormat> {};
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kPacked32> : Packed32<kFormat> {};
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kPacked422> : Packed16<kFormat> {};
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kSemiPlanar> : Planar<kFormat> {};
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kPlanar> : Planar<kFormat> {};

}  // namespace touchline::avx2

#endif
