#pragma once

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/color/avx512/shaded_row.h"
#include "core/color/span_kernel.h"

// Memory layouts of the pixel formats: loading of blocks, extraction of the channels, and the test against the
// background box.
namespace touchline::avx512 {
namespace {  // internal linkage, because only span_kernel.cpp includes this file

// A block is a word of 64 columns.
constexpr std::uint32_t kBlock = kOccupiedWordPixels;
static_assert(kBlock == 64);

// Pixels of a block that are in the span, one bit each.
using Inside = std::uint64_t;
constexpr Inside kWhole = ~Inside{0};
constexpr Inside bits(std::uint32_t begin, std::uint32_t end) { return kWhole >> (64 - (end - begin)) << begin; }

// The bytes among 64 * piece to 64 * piece + 63 that lie in begin..end - 1, one bit each.
constexpr std::uint64_t bytes_inside(std::uint32_t begin, std::uint32_t end, std::uint32_t piece) {
  const std::uint32_t low = std::clamp(begin, 64 * piece, 64 * piece + 64),
                      high = std::clamp(end, low, 64 * piece + 64);
  return low == high ? 0 : bits(low - 64 * piece, high - 64 * piece);
}

// A block that begins at column u. Only its pixels begin to end - 1 may be read.
struct Block {
  std::uint32_t u, begin, end;
  [[nodiscard]] bool is_whole() const { return end - begin == kBlock; }
  [[nodiscard]] Inside inside() const { return bits(begin, end); }
};

// Loads 64 bytes. Bytes outside of begin..end - 1 (counted in the block) are not read and become 0.
template <bool kIsWhole>
TOUCHLINE_TARGET_INLINE __m512i load(const std::uint8_t* bytes, std::uint32_t begin, std::uint32_t end,
                                     std::uint32_t piece) {
  if constexpr (kIsWhole) return _mm512_loadu_si512(bytes + std::size_t{64} * piece);
  return _mm512_maskz_loadu_epi8(bytes_inside(begin, end, piece), bytes + std::size_t{64} * piece);
}
template <bool kIsWhole>
TOUCHLINE_TARGET_INLINE void store(ColorId* colors, const Block& block, __m512i values) {
  if constexpr (kIsWhole) {
    _mm512_storeu_si512(colors + block.u, values);
  } else {
    _mm512_mask_storeu_epi8(colors + block.u, block.inside(), values);
  }
}
// A constant that fills a cache line.
struct alignas(64) Pick : std::array<std::uint8_t, 64> {};
TOUCHLINE_TARGET_INLINE __m512i constant(const Pick& bytes) { return _mm512_load_si512(bytes.data()); }
// Pattern that selects byte first + step * (i / repeat), modulo 128, for byte i.
constexpr Pick pick_bytes(std::size_t first, std::size_t step, std::size_t repeat) {
  Pick pick{};
  for (std::size_t i = 0; i < 64; ++i) pick[i] = static_cast<std::uint8_t>((first + step * (i / repeat)) % 128);
  return pick;
}

// Offsets in TileParameters.
constexpr std::size_t kBackgroundLow = offsetof(TileParameters, background_low),
                      kBackgroundExtent = offsetof(TileParameters, background_extent);
// Pattern for bytes 64 * piece to 64 * piece + 63 of a block: repeats the `period` bytes that begin at `at`.
constexpr Pick repeat_bytes(std::size_t piece, std::size_t at, std::size_t period) {
  Pick pick{};
  for (std::size_t i = 0; i < 64; ++i) pick[i] = static_cast<std::uint8_t>(at + (64 * piece + i) % period);
  return pick;
}

TOUCHLINE_TARGET_INLINE __m512i choose(__m512i bytes, const Pick& pick) {
  return _mm512_maskz_permutexvar_epi8(kWhole, constant(pick), bytes);
}
TOUCHLINE_TARGET_INLINE __m512i choose(__m512i first, __m512i second, const Pick& pick) {
  return _mm512_permutex2var_epi8(first, constant(pick), second);
}

// Returns bytes that are not zero where a value is outside low..low + extent.
TOUCHLINE_TARGET_INLINE __m512i beyond(__m512i bytes, __m512i low, __m512i extent) {
  return _mm512_subs_epu8(_mm512_sub_epi8(bytes, low), extent);
}

struct Planes {
  __m512i first, second, third;
};

// Each layout below has these functions for a block:
// - candidates: returns zero only if all bytes are in the background box, including those outside the span.
// - planes: returns the three channels, with chroma repeated for both pixels of a pair.

// Three bytes per pixel.
template <PixelFormat kFormat>
struct Packed24 {
  static constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
  static constexpr std::array kPick = {pick_bytes(kRed, 3, 1), pick_bytes(1, 3, 1), pick_bytes(2 - kRed, 3, 1)};
  // Pixels whose byte is in the third register.
  static constexpr std::uint64_t in_third(std::size_t offset) {
    std::uint64_t pixels = 0;
    for (std::size_t i = 0; i < 64; ++i) pixels |= std::uint64_t{3 * i + offset >= 128} << i;
    return pixels;
  }
  static constexpr std::array kInThird = {in_third(kRed), in_third(1), in_third(2 - kRed)};
  static constexpr std::array kLow = {repeat_bytes(0, kBackgroundLow, 3), repeat_bytes(1, kBackgroundLow, 3),
                                      repeat_bytes(2, kBackgroundLow, 3)};
  static constexpr std::array kExtent = {repeat_bytes(0, kBackgroundExtent, 3), repeat_bytes(1, kBackgroundExtent, 3),
                                         repeat_bytes(2, kBackgroundExtent, 3)};

  struct Background {
    __m512i low[3], extent[3];
  };
  TOUCHLINE_TARGET_INLINE static Background background(__m512i light) {
    return {{choose(light, kLow[0]), choose(light, kLow[1]), choose(light, kLow[2])},
            {choose(light, kExtent[0]), choose(light, kExtent[1]), choose(light, kExtent[2])}};
  }
  struct Bytes {
    __m512i first, second, third;
  };
  template <bool kIsWhole>
  TOUCHLINE_TARGET_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{3} * block.u;
    const std::uint32_t begin = 3 * block.begin, end = 3 * block.end;
    return {load<kIsWhole>(bytes, begin, end, 0), load<kIsWhole>(bytes, begin, end, 1),
            load<kIsWhole>(bytes, begin, end, 2)};
  }
  TOUCHLINE_TARGET_INLINE static __m512i candidates(const Bytes& bytes, const Background& background) {
    return or_of(beyond(bytes.first, background.low[0], background.extent[0]),
                 beyond(bytes.second, background.low[1], background.extent[1]),
                 beyond(bytes.third, background.low[2], background.extent[2]));
  }
  TOUCHLINE_TARGET_INLINE static Planes planes(const Bytes& bytes) {
    return {channel(bytes, 0), channel(bytes, 1), channel(bytes, 2)};
  }
  TOUCHLINE_TARGET_INLINE static __m512i channel(const Bytes& bytes, std::size_t channel) {
    const __m512i of_first_two = choose(bytes.first, bytes.second, kPick[channel]);
    return _mm512_mask_permutexvar_epi8(of_first_two, kInThird[channel], constant(kPick[channel]), bytes.third);
  }
};

// Four bytes per pixel, the last of them unused.
template <PixelFormat kFormat>
struct Packed32 {
  static constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
  // Pixels 32 to 63 are in the third and fourth register, at the same places as the others in the first two.
  static constexpr std::array kPick = {pick_bytes(kRed, 4, 1), pick_bytes(1, 4, 1), pick_bytes(2 - kRed, 4, 1)};
  static constexpr std::uint64_t kInSecondHalf = kWhole << 32;
  static constexpr Pick kLow = repeat_bytes(0, kBackgroundLow, 4), kExtent = repeat_bytes(0, kBackgroundExtent, 4);

  struct Background {
    __m512i low, extent;
  };
  TOUCHLINE_TARGET_INLINE static Background background(__m512i light) {
    return {choose(light, kLow), choose(light, kExtent)};
  }
  struct Bytes {
    __m512i first, second, third, fourth;
  };
  template <bool kIsWhole>
  TOUCHLINE_TARGET_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{4} * block.u;
    const std::uint32_t begin = 4 * block.begin, end = 4 * block.end;
    return {load<kIsWhole>(bytes, begin, end, 0), load<kIsWhole>(bytes, begin, end, 1),
            load<kIsWhole>(bytes, begin, end, 2), load<kIsWhole>(bytes, begin, end, 3)};
  }
  TOUCHLINE_TARGET_INLINE static __m512i candidates(const Bytes& bytes, const Background& background) {
    const __m512i of_three = or_of(beyond(bytes.first, background.low, background.extent),
                                   beyond(bytes.second, background.low, background.extent),
                                   beyond(bytes.third, background.low, background.extent));
    return _mm512_or_si512(of_three, beyond(bytes.fourth, background.low, background.extent));
  }
  TOUCHLINE_TARGET_INLINE static Planes planes(const Bytes& bytes) {
    return {channel(bytes, 0), channel(bytes, 1), channel(bytes, 2)};
  }
  TOUCHLINE_TARGET_INLINE static __m512i channel(const Bytes& bytes, std::size_t channel) {
    return _mm512_mask_mov_epi8(choose(bytes.first, bytes.second, kPick[channel]), kInSecondHalf,
                                choose(bytes.third, bytes.fourth, kPick[channel]));
  }
};

// Two bytes per pixel.
template <PixelFormat kFormat>
struct Packed16 {
  static constexpr std::size_t kLumaAt = info_of(kFormat).channel[0].offset, kChromaAt = 1 - kLumaAt;
  static constexpr std::array kPick = {pick_bytes(kLumaAt, 2, 1), pick_bytes(kChromaAt, 4, 2),
                                       pick_bytes(kChromaAt + 2, 4, 2)};
  static constexpr std::array kLow = {repeat_bytes(0, kBackgroundLow, 4), repeat_bytes(1, kBackgroundLow, 4)};
  static constexpr std::array kExtent = {repeat_bytes(0, kBackgroundExtent, 4), repeat_bytes(1, kBackgroundExtent, 4)};

  struct Background {
    __m512i first_low, second_low, first_extent, second_extent;
  };
  TOUCHLINE_TARGET_INLINE static Background background(__m512i light) {
    return {choose(light, kLow[0]), choose(light, kLow[1]), choose(light, kExtent[0]), choose(light, kExtent[1])};
  }
  struct Bytes {
    __m512i first, second;
  };
  template <bool kIsWhole>
  TOUCHLINE_TARGET_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    const std::uint8_t* bytes = row.plane[0] + std::size_t{2} * block.u;
    const std::uint32_t begin = 2 * block.begin, end = 2 * block.end;
    return {load<kIsWhole>(bytes, begin, end, 0), load<kIsWhole>(bytes, begin, end, 1)};
  }
  TOUCHLINE_TARGET_INLINE static __m512i candidates(const Bytes& bytes, const Background& background) {
    return _mm512_or_si512(beyond(bytes.first, background.first_low, background.first_extent),
                           beyond(bytes.second, background.second_low, background.second_extent));
  }
  TOUCHLINE_TARGET_INLINE static Planes planes(const Bytes& bytes) {
    return {choose(bytes.first, bytes.second, kPick[0]), choose(bytes.first, bytes.second, kPick[1]),
            choose(bytes.first, bytes.second, kPick[2])};
  }
};

// One byte per pixel and two per pair, in one plane or in two.
template <PixelFormat kFormat>
struct Planar {
  static constexpr std::array kPick = {pick_bytes(0, 2, 2), pick_bytes(1, 2, 2)};
  static constexpr std::array kLow = {repeat_bytes(0, kBackgroundLow, 1), repeat_bytes(0, kBackgroundLow + 2, 2)};
  static constexpr std::array kExtent = {repeat_bytes(0, kBackgroundExtent, 1),
                                         repeat_bytes(0, kBackgroundExtent + 2, 2)};

  struct Background {
    __m512i luma_low, chroma_low, luma_extent, chroma_extent;
  };
  TOUCHLINE_TARGET_INLINE static Background background(__m512i light) {
    return {choose(light, kLow[0]), choose(light, kLow[1]), choose(light, kExtent[0]), choose(light, kExtent[1])};
  }
  // U and V interleaved. Blocks begin and end with whole pairs.
  static constexpr Pick kInterleave = [] {
    Pick pick{};
    for (std::size_t i = 0; i < 64; ++i) pick[i] = static_cast<std::uint8_t>(i % 2 * 64 + i / 2);
    return pick;
  }();
  template <bool kIsWhole>
  TOUCHLINE_TARGET_INLINE static __m512i chroma(const RowPixels& row, const Block& block) {
    if constexpr (info_of(kFormat).packing == Packing::kSemiPlanar) {
      return load<kIsWhole>(row.plane[1] + block.u, block.begin, block.end, 0);
    }
    const std::uint64_t pairs = bits(block.begin / 2, block.end / 2);
    return choose(_mm512_maskz_loadu_epi8(pairs, row.plane[1] + block.u / 2),
                  _mm512_maskz_loadu_epi8(pairs, row.plane[2] + block.u / 2), kInterleave);
  }
  struct Bytes {
    __m512i luma, chroma;
  };
  template <bool kIsWhole>
  TOUCHLINE_TARGET_INLINE static Bytes bytes_of(const RowPixels& row, const Block& block) {
    return {load<kIsWhole>(row.plane[0] + block.u, block.begin, block.end, 0), chroma<kIsWhole>(row, block)};
  }
  TOUCHLINE_TARGET_INLINE static __m512i candidates(const Bytes& bytes, const Background& background) {
    return _mm512_or_si512(beyond(bytes.luma, background.luma_low, background.luma_extent),
                           beyond(bytes.chroma, background.chroma_low, background.chroma_extent));
  }
  TOUCHLINE_TARGET_INLINE static Planes planes(const Bytes& bytes) {
    return {bytes.luma, choose(bytes.chroma, kPick[0]), choose(bytes.chroma, kPick[1])};
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

}  // namespace
}  // namespace touchline::avx512

#endif
