#pragma once

#if defined(__aarch64__)

#include <arm_neon.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/color/neon/nibble_lookup.h"

// Memory layouts of the pixel formats: extraction of the channels, the test against the background box, and the colors
// of a tile.
namespace touchline::neon {
namespace {  // internal linkage, because only span_kernel.cpp includes this file

// The four bytes of the background range in TileParameters, repeated four times.
struct BackgroundWords {
  Values low, extent;
};
Values repeated(const std::array<std::uint8_t, 4>& bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data(), sizeof word);
  return vreinterpretq_u8_u32(vdupq_n_u32(word));
}
BackgroundWords background_words(const TileParameters& light) {
  return {repeated(light.background_low), repeated(light.background_extent)};
}
// Intersects the background ranges of all tiles of a block. Returns false if the intersection is empty, which is
// impossible if all ranges begin at 0.
template <bool kFromZero>
bool background_words(const TileParameters* lights, BackgroundWords& all) {
  all = background_words(lights[0]);
  Values high = vaddq_u8(all.low, all.extent);
  TOUCHLINE_UNROLL for (std::size_t tile = 1; tile < kTilesOfBlock; ++tile) {
    const BackgroundWords one = background_words(lights[tile]);
    all.low = vmaxq_u8(all.low, one.low);
    high = vminq_u8(high, vaddq_u8(one.low, one.extent));
  }
  all.extent = vsubq_u8(high, all.low);
  return kFromZero || is_zero(vcgtq_u8(all.low, high));
}

// R, G and B of 16 pixels.
struct RgbValues {
  Values red, green, blue;
};
// Returns false if the high nibbles show that the tile is background, as they do for most tiles that the background box
// does not reject.
bool may_be_colored(const Within& within, const RgbValues& value) {
  return !is_zero(and_of(vqtbl1q_u8(within.first, vshrq_n_u8(value.red, 4)),
                         and_of(vqtbl1q_u8(within.second, vshrq_n_u8(value.green, 4)),
                                vqtbl1q_u8(within.third, vshrq_n_u8(value.blue, 4)))));
}
[[gnu::always_inline]] inline Values colors_of(const TileNibbles& tables, const RgbValues& value) {
  Values found = vdupq_n_u8(kBackground);
  const Nibbles<Values> a = nibbles_of(value.red), b = nibbles_of(value.green), c = nibbles_of(value.blue);
  for (std::size_t group = 0; group < tables.groups; ++group) {
    const Values classes = and_of(classes_of(tables.first, group, a),
                                  and_of(classes_of(tables.second, group, b), classes_of(tables.third, group, c)));
    found = add_colors(found, tables.colors, group, classes);
  }
  return found;
}

// Three bytes per pixel. kFromZero: background_low is 0 everywhere.
template <PixelFormat kFormat, bool kFromZero>
struct Packed24 {
  static constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
  static constexpr bool kBackgroundFromZero = kFromZero;

  static RowPixels at(const RowPixels& row, std::size_t u) { return {{row.plane[0] + 3 * u}}; }

  // The channel of each of 48 bytes.
  static constexpr auto kPick = [] {
    std::array<std::array<std::uint8_t, kTile>, 3> pick{};
    for (std::size_t i = 0; i < 3 * kTile; ++i) pick[i / kTile][i % kTile] = static_cast<std::uint8_t>(i % 3);
    return pick;
  }();

  struct Background {
    Values low[3], extent[3];
    explicit Background(const BackgroundWords& words) {
      TOUCHLINE_UNROLL for (std::size_t i = 0; i < 3; ++i) {
        if constexpr (!kFromZero) low[i] = vqtbl1q_u8(words.low, vld1q_u8(kPick[i].data()));
        extent[i] = vqtbl1q_u8(words.extent, vld1q_u8(kPick[i].data()));
      }
    }
    template <std::size_t kTiles>
    [[nodiscard]] bool holds(const RowPixels& tiles) const {
      Values beyond = vdupq_n_u8(0);
      TOUCHLINE_UNROLL for (std::size_t i = 0; i < 3; ++i) {
        Values largest = from_low(tiles.plane[0] + kTile * i, i);
        TOUCHLINE_UNROLL for (std::size_t tile = 1; tile < kTiles; ++tile) {
          largest = vmaxq_u8(largest, from_low(tiles.plane[0] + kTile * (3 * tile + i), i));
        }
        beyond = vorrq_u8(beyond, vqsubq_u8(largest, extent[i]));
      }
      return is_zero(beyond);
    }
    [[nodiscard]] Values from_low(const std::uint8_t* bytes, std::size_t i) const {
      if constexpr (kFromZero) return vld1q_u8(bytes);
      return vsubq_u8(vld1q_u8(bytes), low[i]);
    }
  };

  static RgbValues values(const RowPixels& tile) {
    const uint8x16x3_t bytes = vld3q_u8(tile.plane[0]);
    return {bytes.val[kRed], bytes.val[1], bytes.val[2 - kRed]};
  }
  static bool may_be_colored(const Within& within, const RowPixels& tile) {
    return neon::may_be_colored(within, values(tile));
  }
  [[gnu::noinline]] static Values colors(const TileNibbles& tables, RowPixels tile) {
    return colors_of(tables, values(tile));
  }
};

// Four bytes per pixel, the last of them unused.
template <PixelFormat kFormat>
struct Packed32 {
  static constexpr std::size_t kRed = info_of(kFormat).channel[0].offset;
  static constexpr bool kBackgroundFromZero = false;

  static RowPixels at(const RowPixels& row, std::size_t u) { return {{row.plane[0] + 4 * u}}; }

  struct Background {
    BackgroundWords words;
    explicit Background(const BackgroundWords& of_tile) : words(of_tile) {}
    template <std::size_t kTiles>
    [[nodiscard]] bool holds(const RowPixels& tiles) const {
      Values largest = vsubq_u8(vld1q_u8(tiles.plane[0]), words.low);
      TOUCHLINE_UNROLL for (std::size_t i = 1; i < 4 * kTiles; ++i) {
        largest = vmaxq_u8(largest, vsubq_u8(vld1q_u8(tiles.plane[0] + kTile * i), words.low));
      }
      return is_zero(vqsubq_u8(largest, words.extent));
    }
  };

  static RgbValues values(const RowPixels& tile) {
    const uint8x16x4_t bytes = vld4q_u8(tile.plane[0]);
    return {bytes.val[kRed], bytes.val[1], bytes.val[2 - kRed]};
  }
  static bool may_be_colored(const Within& within, const RowPixels& tile) {
    return neon::may_be_colored(within, values(tile));
  }
  [[gnu::noinline]] static Values colors(const TileNibbles& tables, RowPixels tile) {
    return colors_of(tables, values(tile));
  }
};

// Formats whose pixel pairs share a chroma sample.
template <PixelFormat kFormat>
struct SharedChroma {
  static constexpr bool kSeparateUv = info_of(kFormat).packing == Packing::kPlanar;
  static constexpr bool kPlanar = info_of(kFormat).planes > 1, kBackgroundFromZero = false;

  static RowPixels at(const RowPixels& row, std::size_t u) {
    if constexpr (kSeparateUv) return {{row.plane[0] + u, row.plane[1] + u / 2, row.plane[2] + u / 2}};
    return {{row.plane[0] + u * (kPlanar ? 1 : 2), kPlanar ? row.plane[1] + u : nullptr}};
  }

  // Return the first and the second 16 bytes of a tile: consecutive in packed formats, luma and chroma in the others.
  static Values first(const RowPixels& tile) { return vld1q_u8(tile.plane[0]); }
  static Values second(const RowPixels& tile) {
    if constexpr (kSeparateUv) {
      const PairValues u = vld1_u8(tile.plane[1]), v = vld1_u8(tile.plane[2]);
      return vcombine_u8(vzip1_u8(u, v), vzip2_u8(u, v));
    }
    return vld1q_u8(kPlanar ? tile.plane[1] : tile.plane[0] + kTile);
  }

  struct Background {
    BackgroundWords of_first, of_second;
    explicit Background(const BackgroundWords& words) : of_first(words), of_second(words) {
      if constexpr (kPlanar) of_first = {luma(words.low), luma(words.extent)};
      if constexpr (kPlanar) of_second = {chroma(words.low), chroma(words.extent)};
    }
    static Values luma(Values words) { return vdupq_laneq_u8(words, 0); }
    static Values chroma(Values words) { return vreinterpretq_u8_u16(vdupq_laneq_u16(vreinterpretq_u16_u8(words), 1)); }
    template <std::size_t kTiles>
    [[nodiscard]] bool holds(const RowPixels& tiles) const {
      Values largest_first = vsubq_u8(first(tiles), of_first.low);
      Values largest_second = vsubq_u8(second(tiles), of_second.low);
      TOUCHLINE_UNROLL for (std::size_t tile = 1; tile < kTiles; ++tile) {
        largest_first = vmaxq_u8(largest_first, vsubq_u8(first(at(tiles, tile * kTile)), of_first.low));
        largest_second = vmaxq_u8(largest_second, vsubq_u8(second(at(tiles, tile * kTile)), of_second.low));
      }
      return is_zero(vorrq_u8(vqsubq_u8(largest_first, of_first.extent), vqsubq_u8(largest_second, of_second.extent)));
    }
  };

  // Luma of 16 pixels, chroma of 8 pairs.
  struct Samples {
    Values luma;
    PairValues u, v;
  };
  static Samples samples(const RowPixels& tile) {
    if constexpr (kSeparateUv) return {first(tile), vld1_u8(tile.plane[1]), vld1_u8(tile.plane[2])};
    const Values a = first(tile), b = second(tile);
    const bool even = info_of(kFormat).channel[0].offset == 0;
    const Values luma = kPlanar ? a : even ? vuzp1q_u8(a, b) : vuzp2q_u8(a, b);
    const uint16x8_t chroma = vreinterpretq_u16_u8(kPlanar ? b : even ? vuzp2q_u8(a, b) : vuzp1q_u8(a, b));
    return {luma, vmovn_u16(chroma), vshrn_n_u16(chroma, 8)};
  }

  // Returns false if the high nibbles of chroma show that the tile is background, as they do for most tiles that the
  // background box does not reject.
  static bool may_be_colored(const Within& within, const RowPixels& tile) {
    const Samples sample = samples(tile);
    return !is_zero(
        and_of(vqtbl1_u8(within.second, vshr_n_u8(sample.u, 4)), vqtbl1_u8(within.third, vshr_n_u8(sample.v, 4))));
  }

  [[gnu::noinline]] static Values colors(const TileNibbles& tables, RowPixels tile) {
    Values found = vdupq_n_u8(kBackground);
    const Samples sample = samples(tile);
    const Nibbles<PairValues> u = nibbles_of(sample.u), v = nibbles_of(sample.v);
    const Nibbles<Values> luma = nibbles_of(sample.luma);
    for (std::size_t group = 0; group < tables.groups; ++group) {
      const PairValues pairs = and_of(classes_of(tables.second, group, u), classes_of(tables.third, group, v));
      if (is_zero(pairs)) continue;
      // Repeats the classes of each pair for both pixels.
      const Values of_pixels = vcombine_u8(vzip1_u8(pairs, pairs), vzip2_u8(pairs, pairs));
      found = add_colors(found, tables.colors, group, and_of(of_pixels, classes_of(tables.first, group, luma)));
    }
    return found;
  }
};

}  // namespace
}  // namespace touchline::neon

#endif
