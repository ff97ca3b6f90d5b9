#pragma once

#include "core/color/avx2/pixel_layout.h"

#if defined(__x86_64__)

#include <algorithm>
#include <bit>

// Classifies rows with a light map. Every tile of 16 pixels has its own tables. A register holds a tile twice, and each
// half looks up another group of classes.
namespace touchline::avx2 {

// Layout functions that these rows need:
// - tile_planes, candidates of two tiles: see pixel_layout.h.
// - reject_eight_tiles: returns eight bits; a set bit means that the tile is background. Writes background to all of
//   them.
template <class Layout>
struct ShadedLayout : Layout {
  TOUCHLINE_AVX2_INLINE static std::uint64_t reject_eight_tiles(const RowPixels& row, std::uint32_t u,
                                                                const TileParameters* lights, ColorId* colors) {
    const __m256i zero = _mm256_setzero_si256();
    store(colors + u, zero);
    store(colors + u + kBlock, zero);
    store(colors + u + std::size_t{2} * kBlock, zero);
    store(colors + u + std::size_t{3} * kBlock, zero);
    const __m256i p = Layout::candidates(row, {u, u + 4 * kTile, lights, lights + 4}),
                  q = Layout::candidates(row, {u + kTile, u + 5 * kTile, lights + 1, lights + 5}),
                  r = Layout::candidates(row, {u + 2 * kTile, u + 6 * kTile, lights + 2, lights + 6}),
                  s = Layout::candidates(row, {u + 3 * kTile, u + 7 * kTile, lights + 3, lights + 7});
    return zero_halves(p, q, r, s);
  }
};

template <class Layout>
TOUCHLINE_AVX2_INLINE Channels<OneBlock> tile_channels(const NibbleTables& nibbles, const RowPixels& row,
                                                       std::uint32_t u, const TileParameters& light) {
  const Planes planes = Layout::tile_planes(row, u);
  return {{nibbles_of(OneBlock{planes.first}), &nibbles.channel(0, light.level[0])},
          {nibbles_of(OneBlock{planes.second}), &nibbles.channel(1, light.level[1])},
          {nibbles_of(OneBlock{planes.third}), &nibbles.channel(2, light.level[2])}};
}

// Returns the colors of the 16 pixels that begin at column u, considering the classes of two groups.
template <class Layout>
TOUCHLINE_AVX2_INLINE __m128i tile_colors(const NibbleTables& nibbles, std::size_t group, const RowPixels& row,
                                          std::uint32_t u, const TileParameters& light) {
  const Channels<OneBlock> channels = tile_channels<Layout>(nibbles, row, u, light);
  const __m256i found = colors_in<GroupsInRegister::kTwo>(nibbles.colors(), channels, group).first;
  return first_of(_mm256_castsi256_si128(found), _mm256_extracti128_si256(found, 1));
}

// As above, considering the classes of all groups.
template <class Layout>
TOUCHLINE_AVX2_INLINE __m128i tile_colors(const NibbleTables& nibbles, const RowPixels& row, std::uint32_t u,
                                          const TileParameters& light) {
  __m128i colors = tile_colors<Layout>(nibbles, 0, row, u, light);
  for (std::size_t group = 2; group < nibbles.groups(); group += 2) {
    colors = first_of(colors, tile_colors<Layout>(nibbles, group, row, u, light));
  }
  return colors;
}

// A pass takes up to 64 tiles of a row, one bit each.
constexpr std::uint32_t kMaxTilesPerPass = 64, kTilesPerTest = 8;
constexpr std::uint64_t kEveryEighth = 0x1010101010101010u;

// Returns the tiles that may contain a class of the two groups, judged by the high nibbles alone.
template <class Layout>
TOUCHLINE_AVX2_PASS std::uint64_t find_coarse_tiles(const SpanTables& tables, const RowPixels& row, std::uint32_t first,
                                                    std::uint64_t among, std::size_t group) {
  const NibbleTables& nibbles = *tables.nibbles;
  const TileParameters* const lights = tables.tiles + first / kTile;
  const RowPixels pixels = row;
  std::uint64_t found = 0;
  for (; among != 0; among &= among - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(among));
    const Channels<OneBlock> channels = tile_channels<Layout>(nibbles, pixels, first + i * kTile, lights[i]);
    found |= (1 - is_zero(coarse_classes<GroupsInRegister::kTwo>(channels, group).first)) << i;
  }
  return found;
}

// As above, for the classes of all groups.
template <class Layout>
TOUCHLINE_AVX2_INLINE std::uint64_t find_coarse_tiles(const SpanTables& tables, const RowPixels& row,
                                                      std::uint32_t first, std::uint64_t among) {
  std::uint64_t near = 0;
  for (std::size_t group = 0; group < tables.nibbles->groups(); group += 2) {
    near |= find_coarse_tiles<Layout>(tables, row, first, among, group);
  }
  return near;
}

// Classifies the pixels of the tiles that have no color yet.
template <class Layout>
TOUCHLINE_AVX2_PASS OccupiedWords color_tiles(const SpanTables& tables, const RowPixels& row, std::uint32_t first,
                                              std::uint64_t among, std::size_t group, ColorId* colors) {
  const NibbleTables& nibbles = *tables.nibbles;
  const TileParameters* const lights = tables.tiles + first / kTile;
  const RowPixels pixels = row;
  OccupiedWords occupied = 0;
  for (; among != 0; among &= among - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(among));
    const std::uint32_t u = first + i * kTile;
    const __m128i found = first_of(load_half(colors + u), tile_colors<Layout>(nibbles, group, pixels, u, lights[i]));
    store_half(colors + u, found);
    occupied |= (1 - is_zero(found)) << u / kOccupiedWordPixels;
  }
  return occupied;
}

// Returns the tiles that the background box does not reject. Writes background to all tiles.
template <class Layout>
TOUCHLINE_AVX2_PASS std::uint64_t find_candidate_tiles(const SpanTables& tables, const RowPixels& row,
                                                       std::uint32_t first, std::uint32_t count, ColorId* colors) {
  const TileParameters* const lights = tables.tiles + first / kTile;
  const RowPixels pixels = row;
  std::uint64_t background = 0;
  std::uint32_t i = 0;
  for (; i + kTilesPerTest <= count; i += kTilesPerTest) {
    background |= Layout::reject_eight_tiles(pixels, first + i * kTile, lights + i, colors) << i;
  }
  if (i < count && count >= kTilesPerTest) {
    i = count - kTilesPerTest;
    background |= Layout::reject_eight_tiles(pixels, first + i * kTile, lights + i, colors) << i;
  } else {
    for (; i < count; ++i) store_half(colors + first + std::size_t{kTile} * i, _mm_setzero_si128());
  }
  return ~background;
}

// Removes the tiles that lie in the pale range. Takes them in pairs, one in each half of a register.
template <class Layout>
TOUCHLINE_AVX2_PASS std::uint64_t without_pale_tiles(const TileParameters& pale, const RowPixels& row,
                                                     std::uint32_t first, std::uint64_t among) {
  const auto of_row = Layout::background_of_tiles(pale);
  const RowPixels pixels = row;
  std::uint64_t left = 0;
  while (among != 0) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(among));
    among &= among - 1;
    const auto j = among != 0 ? static_cast<std::uint32_t>(std::countr_zero(among)) : i;
    among &= among - 1;
    const __m256i beyond = Layout::candidates(pixels, first + i * kTile, first + j * kTile, of_row);
    left |= (1 - is_zero(_mm256_castsi256_si128(beyond))) << i | (1 - is_zero(_mm256_extracti128_si256(beyond, 1)))
                                                                     << j;
  }
  return left;
}

// Classifies whole tiles, if there are any.
template <class Layout>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_shaded_tiles(const SpanTables& tables, const RowPixels& row,
                                                          std::uint32_t begin, std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  for (std::uint32_t first = begin; first < end; first += kMaxTilesPerPass * kTile) {
    const std::uint32_t count = std::min(kMaxTilesPerPass, (end - first) / kTile);
    const std::uint64_t all = ~std::uint64_t{0} >> (kMaxTilesPerPass - count);
    std::uint64_t left = find_candidate_tiles<Layout>(tables, row, first, count, colors);
    left = tables.has_background_box ? left & all : all;
    if (tables.pale != nullptr && left != 0) left = without_pale_tiles<Layout>(*tables.pale, row, first, left);
    // The coarse test does not pay off for two tiles, or if most tiles contain colors. If most tiles are candidates,
    // every eighth is tested, to estimate how many contain colors.
    const auto number = static_cast<std::uint32_t>(std::popcount(left));
    if (number > 2) {
      const std::uint64_t sample = 2 * number <= count ? left : left & kEveryEighth;
      const std::uint64_t near = find_coarse_tiles<Layout>(tables, row, first, sample);
      if (sample == left) {
        left = near;
      } else if (2 * std::popcount(near) < std::popcount(sample)) {
        left = near | find_coarse_tiles<Layout>(tables, row, first, left & ~sample);
      }
    }
    for (std::size_t group = 0; left != 0 && group < tables.nibbles->groups(); group += 2) {
      occupied |= color_tiles<Layout>(tables, row, first, left, group, colors);
    }
  }
  return occupied;
}

// Classifies the incomplete tiles at both ends of the span. The span is at least a tile wide.
template <class Layout>
TOUCHLINE_AVX2_PASS OccupiedWords classify_ends(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                                std::uint32_t end, ColorId* colors) {
  const std::uint32_t last = end - kTile;
  // Most regions of interest end on the floor, so both ends are usually background.
  const TwoTiles ends = {begin, last, &tables.tile_at(begin), &tables.tile_at(end - 1)};
  if (tables.has_background_box && is_zero(Layout::candidates(row, ends)) != 0) {
    store_half(colors + begin, _mm_setzero_si128());
    store_half(colors + last, _mm_setzero_si128());
    return 0;
  }
  const auto of_first = static_cast<char>((kTile - begin % kTile) % kTile),
             before_last = static_cast<char>(kTile - end % kTile);
  const __m128i place = _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m128i first_colors = _mm_and_si128(tile_colors<Layout>(*tables.nibbles, row, begin, tables.tile_at(begin)),
                                             _mm_cmplt_epi8(place, _mm_set1_epi8(of_first)));
  const __m128i last_colors =
      _mm_andnot_si128(_mm_cmplt_epi8(place, _mm_set1_epi8(before_last)),
                       tile_colors<Layout>(*tables.nibbles, row, last, tables.tile_at(end - 1)));
  // The two tiles may overlap.
  store_half(colors + last, _mm_setzero_si128());
  store_half(colors + begin, first_colors);
  store_half(colors + last, _mm_or_si128(load_half(colors + last), last_colors));
  return (1 - is_zero(first_colors)) << begin / kOccupiedWordPixels | (1 - is_zero(last_colors))
                                                                          << (end - 1) / kOccupiedWordPixels;
}

// The span is at least a tile wide.
template <class Layout>
TOUCHLINE_AVX2_INLINE OccupiedWords classify_shaded_span(const SpanTables& tables, const RowPixels& row,
                                                         std::uint32_t begin, std::uint32_t end, ColorId* colors) {
  OccupiedWords occupied = 0;
  if (begin % kTile != 0 || end % kTile != 0) occupied = classify_ends<Layout>(tables, row, begin, end, colors);
  const std::uint32_t first = (begin + kTile - 1) / kTile * kTile, stop = end / kTile * kTile;
  return occupied | classify_shaded_tiles<Layout>(tables, row, first, stop, colors);
}

}  // namespace touchline::avx2

#endif
