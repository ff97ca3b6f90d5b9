#pragma once

#if defined(__x86_64__)

#include "core/cpu.h"

// The table look-ups of the AVX2 kernel, compiled for AVX-512. It has twice as many registers: enough for all passes in
// one function.
#undef TOUCHLINE_TARGET
#undef TOUCHLINE_TARGET_NAMESPACE
#undef TOUCHLINE_PASS
#define TOUCHLINE_TARGET TOUCHLINE_AVX512_TARGET
#define TOUCHLINE_TARGET_NAMESPACE avx512_shaded
#define TOUCHLINE_PASS [[gnu::target(TOUCHLINE_TARGET), gnu::always_inline]] inline
#include "core/color/avx2/shaded_row.h"

// Rows with a light map in the AVX-512 kernel. The background test takes four tiles (64 pixels) at a time, and the
// exact test one tile.
namespace touchline::avx512_shaded {

// A constant that fills a cache line.
struct alignas(64) Bytes64 : std::array<std::uint8_t, 64> {};
TOUCHLINE_TARGET_INLINE __m512i choose(__m512i bytes, const Bytes64& which) {
  return _mm512_maskz_permutexvar_epi8(~0ULL, _mm512_load_si512(which.data()), bytes);
}

// Pattern for the bytes 64 * piece to 64 * piece + 63 of four tiles with `tile_bytes` each: from the parameters of each
// tile, repeats the `period` bytes that begin at `at`.
constexpr Bytes64 bytes_of_lights(std::size_t piece, std::size_t tile_bytes, std::size_t at, std::size_t period) {
  Bytes64 which{};
  for (std::size_t i = 0; i < 64; ++i) {
    const std::size_t byte = 64 * piece + i;
    which[i] = static_cast<std::uint8_t>(sizeof(TileParameters) * (byte / tile_bytes) + at + byte % period);
  }
  return which;
}
TOUCHLINE_TARGET_INLINE __m512i four_lights(const TileParameters* lights) {
  return _mm512_maskz_loadu_epi8(~0ULL >> (64 - 4 * sizeof(TileParameters)), lights);
}

// Returns a bit for each eight bytes that contain a value outside the background range.
TOUCHLINE_TARGET_INLINE std::uint64_t candidate_words(__m512i bytes, __m512i lights, const Bytes64& low,
                                                      const Bytes64& extent) {
  const __m512i candidates = _mm512_subs_epu8(_mm512_sub_epi8(bytes, choose(lights, low)), choose(lights, extent));
  return _mm512_test_epi64_mask(candidates, candidates);
}

constexpr std::size_t kLow = offsetof(TileParameters, background_low),
                      kExtent = offsetof(TileParameters, background_extent);

// Three bytes per pixel.
inline constexpr std::array kLowOf24 = {bytes_of_lights(0, 48, kLow, 3), bytes_of_lights(1, 48, kLow, 3),
                                        bytes_of_lights(2, 48, kLow, 3)};
inline constexpr std::array kExtentOf24 = {bytes_of_lights(0, 48, kExtent, 3), bytes_of_lights(1, 48, kExtent, 3),
                                           bytes_of_lights(2, 48, kExtent, 3)};
// Four bytes per pixel.
inline constexpr std::array kLowOf32 = {bytes_of_lights(0, 64, kLow, 4), bytes_of_lights(1, 64, kLow, 4),
                                        bytes_of_lights(2, 64, kLow, 4), bytes_of_lights(3, 64, kLow, 4)};
inline constexpr std::array kExtentOf32 = {bytes_of_lights(0, 64, kExtent, 4), bytes_of_lights(1, 64, kExtent, 4),
                                           bytes_of_lights(2, 64, kExtent, 4), bytes_of_lights(3, 64, kExtent, 4)};
// Two bytes per pixel.
inline constexpr std::array kLowOf16 = {bytes_of_lights(0, 32, kLow, 4), bytes_of_lights(1, 32, kLow, 4)};
inline constexpr std::array kExtentOf16 = {bytes_of_lights(0, 32, kExtent, 4), bytes_of_lights(1, 32, kExtent, 4)};
// One byte per pixel and two per pair.
inline constexpr Bytes64 kLowOfLuma = bytes_of_lights(0, 16, kLow, 1),
                         kExtentOfLuma = bytes_of_lights(0, 16, kExtent, 1);
inline constexpr Bytes64 kLowOfChroma = bytes_of_lights(0, 16, kLow + 2, 2),
                         kExtentOfChroma = bytes_of_lights(0, 16, kExtent + 2, 2);

// Pattern that selects the 16 bytes first + step * (i / repeat), twice.
constexpr Bytes64 plane_of_tile(std::size_t first, std::size_t step, std::size_t repeat) {
  Bytes64 which{};
  for (std::size_t i = 0; i < 32; ++i) which[i] = static_cast<std::uint8_t>(first + step * (i % 16 / repeat));
  return which;
}
inline constexpr std::array kPlaneOf24 = {plane_of_tile(0, 3, 1), plane_of_tile(1, 3, 1), plane_of_tile(2, 3, 1)};
inline constexpr std::array kPlaneOf32 = {plane_of_tile(0, 4, 1), plane_of_tile(1, 4, 1), plane_of_tile(2, 4, 1)};
inline constexpr std::array kLumaOf16 = {plane_of_tile(0, 2, 1), plane_of_tile(1, 2, 1)};
inline constexpr std::array kChromaOf16 = {plane_of_tile(0, 4, 2), plane_of_tile(1, 4, 2), plane_of_tile(2, 4, 2),
                                           plane_of_tile(3, 4, 2)};
TOUCHLINE_TARGET_INLINE __m256i plane(__m256i bytes, const Bytes64& which) {
  return _mm256_maskz_permutexvar_epi8(~0U, load(which.data()), bytes);
}
TOUCHLINE_TARGET_INLINE __m256i plane(__m512i bytes, const Bytes64& which) {
  return _mm512_maskz_extracti64x4_epi64(0xff, choose(bytes, which), 0);
}

// Each layout below has these functions:
// - candidate_words: returns a bit for each eight bytes of 64 pixels, in memory order, that contain a candidate. A tile
//   has kWords bits. With several planes, their bits are combined.
// - tile_planes, candidates of two tiles: as in the AVX2 kernel.

template <PixelFormat kFormat>
struct ShadedPacked24 : Packed24<kFormat> {
  static constexpr std::uint32_t kWords = 6;
  TOUCHLINE_TARGET_INLINE static std::uint64_t candidate_words(const RowPixels& row, std::uint32_t u,
                                                               const TileParameters* lights) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{3} * u;
    const __m512i light = four_lights(lights);
    return avx512_shaded::candidate_words(_mm512_loadu_si512(bytes), light, kLowOf24[0], kExtentOf24[0]) |
           avx512_shaded::candidate_words(_mm512_loadu_si512(bytes + 64), light, kLowOf24[1], kExtentOf24[1]) << 8 |
           avx512_shaded::candidate_words(_mm512_loadu_si512(bytes + 128), light, kLowOf24[2], kExtentOf24[2]) << 16;
  }
  TOUCHLINE_TARGET_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
    const __m512i bytes = _mm512_maskz_loadu_epi8(~0ULL >> 16, row.plane[0] + std::size_t{3} * u);
    return {plane(bytes, kPlaneOf24[kRed]), plane(bytes, kPlaneOf24[1]), plane(bytes, kPlaneOf24[2 - kRed])};
  }
};

template <PixelFormat kFormat>
struct ShadedPacked32 : Packed32<kFormat> {
  static constexpr std::uint32_t kWords = 8;
  TOUCHLINE_TARGET_INLINE static std::uint64_t candidate_words(const RowPixels& row, std::uint32_t u,
                                                               const TileParameters* lights) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{4} * u;
    const __m512i light = four_lights(lights);
    return avx512_shaded::candidate_words(_mm512_loadu_si512(bytes), light, kLowOf32[0], kExtentOf32[0]) |
           avx512_shaded::candidate_words(_mm512_loadu_si512(bytes + 64), light, kLowOf32[1], kExtentOf32[1]) << 8 |
           avx512_shaded::candidate_words(_mm512_loadu_si512(bytes + 128), light, kLowOf32[2], kExtentOf32[2]) << 16 |
           avx512_shaded::candidate_words(_mm512_loadu_si512(bytes + 192), light, kLowOf32[3], kExtentOf32[3]) << 24;
  }
  TOUCHLINE_TARGET_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
    const __m512i bytes = _mm512_loadu_si512(row.plane[0] + std::size_t{4} * u);
    return {plane(bytes, kPlaneOf32[kRed]), plane(bytes, kPlaneOf32[1]), plane(bytes, kPlaneOf32[2 - kRed])};
  }
};

template <PixelFormat kFormat>
struct ShadedPacked16 : Packed16<kFormat> {
  static constexpr std::uint32_t kWords = 4;
  TOUCHLINE_TARGET_INLINE static std::uint64_t candidate_words(const RowPixels& row, std::uint32_t u,
                                                               const TileParameters* lights) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{2} * u;
    const __m512i light = four_lights(lights);
    return avx512_shaded::candidate_words(_mm512_loadu_si512(bytes), light, kLowOf16[0], kExtentOf16[0]) |
           avx512_shaded::candidate_words(_mm512_loadu_si512(bytes + 64), light, kLowOf16[1], kExtentOf16[1]) << 8;
  }
  TOUCHLINE_TARGET_INLINE static Planes tile_planes(const RowPixels& row, std::uint32_t u) {
    constexpr std::size_t kLuma = info_of(kFormat).channel[0].offset, kChroma = 1 - kLuma;
    const __m256i bytes = load(row.plane[0] + std::size_t{2} * u);
    return {plane(bytes, kLumaOf16[kLuma]), plane(bytes, kChromaOf16[kChroma]), plane(bytes, kChromaOf16[kChroma + 2])};
  }
};

// Interleaves 32 bytes each of U and V.
inline constexpr Bytes64 kInterleave = [] {
  Bytes64 which{};
  for (std::size_t i = 0; i < 64; ++i) which[i] = static_cast<std::uint8_t>(i % 2 * 64 + i / 2);
  return which;
}();

template <PixelFormat kFormat>
struct ShadedPlanar : Planar<kFormat> {
  static constexpr std::uint32_t kWords = 2;
  TOUCHLINE_TARGET_INLINE static __m512i chroma_of_four_tiles(const RowPixels& row, std::uint32_t u) {
    if constexpr (!Planar<kFormat>::kSeparateUv) return _mm512_loadu_si512(row.plane[1] + u);
    const __m512i first = _mm512_maskz_loadu_epi8(~0ULL >> 32, row.plane[1] + u / 2),
                  second = _mm512_maskz_loadu_epi8(~0ULL >> 32, row.plane[2] + u / 2);
    return _mm512_permutex2var_epi8(first, _mm512_load_si512(kInterleave.data()), second);
  }
  TOUCHLINE_TARGET_INLINE static std::uint64_t candidate_words(const RowPixels& row, std::uint32_t u,
                                                               const TileParameters* lights) {
    const __m512i light = four_lights(lights);
    return avx512_shaded::candidate_words(_mm512_loadu_si512(row.plane[0] + u), light, kLowOfLuma, kExtentOfLuma) |
           avx512_shaded::candidate_words(chroma_of_four_tiles(row, u), light, kLowOfChroma, kExtentOfChroma);
  }
};

// Adds the function that classify_shaded_span() needs.
template <class Layout>
struct ShadedLayout512 : Layout {
  TOUCHLINE_TARGET_INLINE static std::uint64_t reject_eight_tiles(const RowPixels& row, std::uint32_t u,
                                                                  const TileParameters* lights, ColorId* colors) {
    constexpr std::uint32_t kWords = Layout::kWords;
    const std::uint64_t words = Layout::candidate_words(row, u, lights) |
                                Layout::candidate_words(row, u + 4 * kTile, lights + 4) << (4 * kWords);
    _mm512_storeu_si512(colors + u, _mm512_setzero_si512());
    _mm512_storeu_si512(colors + u + std::size_t{4} * kTile, _mm512_setzero_si512());
    std::uint64_t candidates = words | words >> 1;
    if constexpr (kWords == 4) candidates |= candidates >> 2;
    if constexpr (kWords == 6) candidates |= candidates >> 2 | candidates >> 4;
    if constexpr (kWords == 8) candidates |= candidates >> 2 | candidates >> 4 | candidates >> 6;
    constexpr std::uint64_t kFirstWords = [] {
      std::uint64_t first = 0;
      for (std::uint32_t tile = 0; tile < 8; ++tile) first |= std::uint64_t{1} << tile * kWords;
      return first;
    }();
    return ~_pext_u64(candidates, kFirstWords) & 0xff;
  }
};

template <PixelFormat kFormat, Packing kPacking = info_of(kFormat).packing>
struct ShadedBytesOf;
template <PixelFormat kFormat>
struct ShadedBytesOf<kFormat, Packing::kPacked24> : ShadedPacked24<kFormat> {};
template <PixelFormat kFormat>
struct ShadedBytesOf<kFormat, Packing::kPacked32> : ShadedPacked32<kFormat> {};
template <PixelFormat kFormat>
struct ShadedBytesOf<kFormat, Packing::kPacked422> : ShadedPacked16<kFormat> {};
template <PixelFormat kFormat>
struct ShadedBytesOf<kFormat, Packing::kSemiPlanar> : ShadedPlanar<kFormat> {};
template <PixelFormat kFormat>
struct ShadedBytesOf<kFormat, Packing::kPlanar> : ShadedPlanar<kFormat> {};
template <PixelFormat kFormat>
using ShadedLayoutOf = ShadedLayout512<ShadedBytesOf<kFormat>>;

}  // namespace touchline::avx512_shaded

#endif
