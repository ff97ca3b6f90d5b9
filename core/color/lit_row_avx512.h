#pragma once

#if defined(__x86_64__)

// The look-ups of the AVX2 kernel, with twice the registers: enough for all looks in one function.
#define TOUCHLINE_AVX2_TARGET "avx512f,avx512bw,avx512vl,avx512vbmi,bmi,bmi2,popcnt"
#define TOUCHLINE_AVX2_NAMESPACE lit512
#define TOUCHLINE_AVX2_LOOK [[gnu::target(TOUCHLINE_AVX2_TARGET), gnu::always_inline]] inline

#include "core/color/lit_row_avx2.h"

// Rows with a light map as the AVX-512 kernel looks at them: 64 pixels in four tiles at a time while they are quiet,
// and a tile at a time what is not.
namespace touchline::lit512 {

// A constant, in one cache line.
struct alignas(64) Bytes64 : std::array<std::uint8_t, 64> {};
TOUCHLINE_AVX2_INLINE __m512i choose(__m512i bytes, const Bytes64& which) {
  return _mm512_maskz_permutexvar_epi8(~0ULL, _mm512_load_si512(which.data()), bytes);
}

// Of four tiles' lights: for bytes 64 * piece to 64 * piece + 63, of which a tile has `tile_bytes`, the `period` bytes
// from `at` on over and over.
constexpr Bytes64 bytes_of_lights(std::size_t piece, std::size_t tile_bytes, std::size_t at, std::size_t period) {
  Bytes64 which{};
  for (std::size_t i = 0; i < 64; ++i) {
    const std::size_t byte = 64 * piece + i;
    which[i] = static_cast<std::uint8_t>(sizeof(TileLight) * (byte / tile_bytes) + at + byte % period);
  }
  return which;
}
TOUCHLINE_AVX2_INLINE __m512i four_lights(const TileLight* lights) {
  return _mm512_maskz_loadu_epi8(~0ULL >> (64 - 4 * sizeof(TileLight)), lights);
}

// A bit for each eight bytes: whether one is farther above quiet_low than quiet_reach.
TOUCHLINE_AVX2_INLINE std::uint64_t loud_words(__m512i bytes, __m512i lights, const Bytes64& low,
                                               const Bytes64& reach) {
  const __m512i loud = _mm512_subs_epu8(_mm512_sub_epi8(bytes, choose(lights, low)), choose(lights, reach));
  return _mm512_test_epi64_mask(loud, loud);
}

constexpr std::size_t kLow = offsetof(TileLight, quiet_low), kReach = offsetof(TileLight, quiet_reach);

// Three bytes a pixel.
inline constexpr std::array kLowOf24 = {bytes_of_lights(0, 48, kLow, 3), bytes_of_lights(1, 48, kLow, 3),
                                        bytes_of_lights(2, 48, kLow, 3)};
inline constexpr std::array kReachOf24 = {bytes_of_lights(0, 48, kReach, 3), bytes_of_lights(1, 48, kReach, 3),
                                          bytes_of_lights(2, 48, kReach, 3)};
// Two bytes a pixel.
inline constexpr std::array kLowOf16 = {bytes_of_lights(0, 32, kLow, 4), bytes_of_lights(1, 32, kLow, 4)};
inline constexpr std::array kReachOf16 = {bytes_of_lights(0, 32, kReach, 4), bytes_of_lights(1, 32, kReach, 4)};
// A byte a pixel, and two a pair.
inline constexpr Bytes64 kLowOfLuma = bytes_of_lights(0, 16, kLow, 1), kReachOfLuma = bytes_of_lights(0, 16, kReach, 1);
inline constexpr Bytes64 kLowOfChroma = bytes_of_lights(0, 16, kLow + 2, 2),
                         kReachOfChroma = bytes_of_lights(0, 16, kReach + 2, 2);

// Twice the 16 bytes first + step * (i / repeat).
constexpr Bytes64 plane_of_tile(std::size_t first, std::size_t step, std::size_t repeat) {
  Bytes64 which{};
  for (std::size_t i = 0; i < 32; ++i) which[i] = static_cast<std::uint8_t>(first + step * (i % 16 / repeat));
  return which;
}
inline constexpr std::array kPlaneOf24 = {plane_of_tile(0, 3, 1), plane_of_tile(1, 3, 1), plane_of_tile(2, 3, 1)};
inline constexpr std::array kLumaOf16 = {plane_of_tile(0, 2, 1), plane_of_tile(1, 2, 1)};
inline constexpr std::array kChromaOf16 = {plane_of_tile(0, 4, 2), plane_of_tile(1, 4, 2), plane_of_tile(2, 4, 2),
                                           plane_of_tile(3, 4, 2)};
TOUCHLINE_AVX2_INLINE __m256i plane(__m256i bytes, const Bytes64& which) {
  return _mm256_maskz_permutexvar_epi8(~0U, load(which.data()), bytes);
}
TOUCHLINE_AVX2_INLINE __m256i plane(__m512i bytes, const Bytes64& which) {
  return _mm512_maskz_extracti64x4_epi64(0xff, choose(bytes, which), 0);
}

// The layouts below give
// - loud_words: of 64 pixels a bit for each eight bytes as they follow each other, kWords of a tile; of planes one or
//   the other,
// - tile_planes, as those of the AVX2 kernel.

template <PixelFormat kFormat>
struct Lit24 {
  static constexpr std::uint32_t kWords = 6;
  TOUCHLINE_AVX2_INLINE static std::uint64_t loud_words(const RowPixels& row, std::uint32_t u,
                                                        const TileLight* lights) {
    const std::uint8_t* bytes = row.samples + std::size_t{3} * u;
    const __m512i light = four_lights(lights);
    return lit512::loud_words(_mm512_loadu_si512(bytes), light, kLowOf24[0], kReachOf24[0]) |
           lit512::loud_words(_mm512_loadu_si512(bytes + 64), light, kLowOf24[1], kReachOf24[1]) << 8 |
           lit512::loud_words(_mm512_loadu_si512(bytes + 128), light, kLowOf24[2], kReachOf24[2]) << 16;
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    constexpr std::size_t kRed = kFormat == PixelFormat::kRgb24 ? 0 : 2;
    const __m512i bytes = _mm512_maskz_loadu_epi8(~0ULL >> 16, row.samples + std::size_t{3} * u);
    return {plane(bytes, kPlaneOf24[kRed]), plane(bytes, kPlaneOf24[1]), plane(bytes, kPlaneOf24[2 - kRed])};
  }
};

template <PixelFormat kFormat>
struct Lit16 {
  static constexpr std::uint32_t kWords = 4;
  TOUCHLINE_AVX2_INLINE static std::uint64_t loud_words(const RowPixels& row, std::uint32_t u,
                                                        const TileLight* lights) {
    const std::uint8_t* bytes = row.samples + std::size_t{2} * u;
    const __m512i light = four_lights(lights);
    return lit512::loud_words(_mm512_loadu_si512(bytes), light, kLowOf16[0], kReachOf16[0]) |
           lit512::loud_words(_mm512_loadu_si512(bytes + 64), light, kLowOf16[1], kReachOf16[1]) << 8;
  }
  TOUCHLINE_AVX2_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    constexpr std::size_t kLuma = kFormat == PixelFormat::kYuyv ? 0 : 1, kChroma = 1 - kLuma;
    const __m256i bytes = load(row.samples + std::size_t{2} * u);
    return {plane(bytes, kLumaOf16[kLuma]), plane(bytes, kChromaOf16[kChroma]), plane(bytes, kChromaOf16[kChroma + 2])};
  }
};

struct LitPlanar : Planar {
  static constexpr std::uint32_t kWords = 2;
  TOUCHLINE_AVX2_INLINE static std::uint64_t loud_words(const RowPixels& row, std::uint32_t u,
                                                        const TileLight* lights) {
    const __m512i light = four_lights(lights);
    return lit512::loud_words(_mm512_loadu_si512(row.samples + u), light, kLowOfLuma, kReachOfLuma) |
           lit512::loud_words(_mm512_loadu_si512(row.chroma + u), light, kLowOfChroma, kReachOfChroma);
  }
};

// What classify_lit_span needs of a layout.
template <class Layout>
struct LitLayout512 : Layout {
  TOUCHLINE_AVX2_INLINE static std::uint64_t eight_quiet(const RowPixels& row, std::uint32_t u, const TileLight* lights,
                                                         ColorId* colors) {
    constexpr std::uint32_t kWords = Layout::kWords;
    const std::uint64_t words = Layout::loud_words(row, u, lights) | Layout::loud_words(row, u + 4 * kTile, lights + 4)
                                                                         << (4 * kWords);
    _mm512_storeu_si512(colors + u, _mm512_setzero_si512());
    _mm512_storeu_si512(colors + u + std::size_t{4} * kTile, _mm512_setzero_si512());
    std::uint64_t loud = words | words >> 1;
    if constexpr (kWords == 4) loud |= loud >> 2;
    if constexpr (kWords == 6) loud |= loud >> 2 | loud >> 4;
    constexpr std::uint64_t kFirstWords = [] {
      std::uint64_t first = 0;
      for (std::uint32_t tile = 0; tile < 8; ++tile) first |= std::uint64_t{1} << tile * kWords;
      return first;
    }();
    return ~_pext_u64(loud, kFirstWords) & 0xff;
  }
};

template <PixelFormat kFormat>
using LitLayoutOf =
    LitLayout512<std::conditional_t<color_space(kFormat) == ColorSpace::kRgb, Lit24<kFormat>,
                                    std::conditional_t<kFormat == PixelFormat::kNv12, LitPlanar, Lit16<kFormat>>>>;

}  // namespace touchline::lit512

#endif
