#pragma once

#if defined(__x86_64__)

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/color/span_kernel.h"

// How the AVX2 kernel reads a block of pixels of each format.
namespace touchline::avx2 {

// Every function carries the target itself: a file compiled for AVX2 as a whole would leave AVX2 code in functions that
// it shares with other files, and on an older processor the linker may have picked those.
#define TOUCHLINE_AVX2 [[gnu::target("avx2,bmi,popcnt")]]
#define TOUCHLINE_AVX2_INLINE [[gnu::target("avx2,bmi,popcnt"), gnu::always_inline]] inline

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
// 1 or 0, as a number: no branch.
TOUCHLINE_AVX2_INLINE std::uint64_t is_zero(__m256i value) {
  return static_cast<std::uint64_t>(_mm256_testz_si256(value, value));
}

// The light of the tiles in the lower and the upper half; the same one where there is but one.
struct Lights {
  const TileLight *low, *high;
};

TOUCHLINE_AVX2_INLINE __m256i four_bytes(const std::array<std::uint8_t, 4>& bytes) {
  return _mm256_set1_epi32(std::bit_cast<int>(bytes));
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

  // Of the 96 bytes of a block, the first 48 in the tile of the lower half. Quiet values begin at 0.
  struct Quiet {
    __m256i reach[3];
  };
  template <bool kOneLight>
  TOUCHLINE_AVX2_INLINE static Quiet quiet(const Lights& lights) {
    const __m256i low = four_bytes(lights.low->quiet_reach), high = four_bytes(lights.high->quiet_reach);
    const __m256i both = kOneLight ? low : _mm256_blend_epi32(low, high, 0b11110000);
    return {{_mm256_shuffle_epi8(low, load(kPeriod[0].data())), _mm256_shuffle_epi8(both, load(kPeriod[1].data())),
             _mm256_shuffle_epi8(kOneLight ? low : high, load(kPeriod[2].data()))}};
  }
  TOUCHLINE_AVX2_INLINE static __m256i loud(const RowPixels& row, std::uint32_t u, const Quiet& quiet) {
    const std::uint8_t* bytes = row.samples + std::size_t{3} * u;
    return _mm256_or_si256(_mm256_subs_epu8(load(bytes), quiet.reach[0]),
                           _mm256_or_si256(_mm256_subs_epu8(load(bytes + 32), quiet.reach[1]),
                                           _mm256_subs_epu8(load(bytes + 64), quiet.reach[2])));
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

}  // namespace touchline::avx2

#endif
