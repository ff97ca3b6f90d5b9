#include "core/color/span_kernel.h"

#if defined(__aarch64__)

#include <arm_neon.h>

#include <cstring>
#include <type_traits>

#include "core/color/kernel_of_format.h"

namespace touchline {
namespace neon {
namespace {

// A tile fills a register. The background test takes four tiles; if it fails, tiles are tested one by one.
constexpr std::uint32_t kTile = kTileWidth, kTilesOfBlock = 4, kBlock = kTilesOfBlock * kTile;
static_assert(kTile == 16 && kBackground == 0);

using Values = uint8x16_t;  // of a tile's pixels
using PairValues = uint8x8_t;

// Unrolls short loops over tiles and channels, so that the arrays stay in registers.
#define TOUCHLINE_UNROLL _Pragma("GCC unroll 4")

bool is_zero(Values value) {
  const uint32x4_t words = vreinterpretq_u32_u8(value);
  return vgetq_lane_u64(vreinterpretq_u64_u32(vpmaxq_u32(words, words)), 0) == 0;
}
bool is_zero(PairValues value) { return vget_lane_u64(vreinterpret_u64_u8(value), 0) == 0; }

// For 16 pixels and for 8 pairs. A Cortex-A72 looks up half a register in a third of the time.
Values look_up(const std::uint8_t* table, Values nibble) { return vqtbl1q_u8(vld1q_u8(table), nibble); }
PairValues look_up(const std::uint8_t* table, PairValues nibble) { return vqtbl1_u8(vld1q_u8(table), nibble); }
Values and_of(Values a, Values b) { return vandq_u8(a, b); }
PairValues and_of(PairValues a, PairValues b) { return vand_u8(a, b); }
Values or_of(Values a, Values b) { return vorrq_u8(a, b); }
PairValues or_of(PairValues a, PairValues b) { return vorr_u8(a, b); }

// High and low nibbles of values.
template <class Register>
struct Nibbles {
  Register high, low;
};
Nibbles<Values> nibbles_of(Values values) { return {vshrq_n_u8(values, 4), vandq_u8(values, vdupq_n_u8(15))}; }
Nibbles<PairValues> nibbles_of(PairValues values) { return {vshr_n_u8(values, 4), vand_u8(values, vdup_n_u8(15))}; }

// Tables of a group, by their distance from the first. One address serves all; otherwise gcc 12 computes each one.
class GroupTables {
 public:
  GroupTables(const GroupLookups& first, std::size_t group) : at_(first[group].data()) { asm("" : "+r"(at_)); }
  [[nodiscard]] const std::uint8_t* operator[](std::size_t number) const { return at_ + sizeof(GroupLookups) * number; }

 private:
  const std::uint8_t* at_;
};
static_assert(offsetof(ChannelNibbles, to_last) == 4 * sizeof(GroupLookups));

// Classes of the group to which the values of a channel belong, one byte per value.
template <class Register>
Register classes_of(const ChannelNibbles& tables, std::size_t group, const Nibbles<Register>& value) {
  const GroupTables within_and_ends(tables.within, group);
  const Register from = or_of(look_up(within_and_ends[1], value.high), look_up(within_and_ends[2], value.low));
  const Register to = or_of(look_up(within_and_ends[3], value.high), look_up(within_and_ends[4], value.low));
  return and_of(look_up(within_and_ends[0], value.high), and_of(from, to));
}

// Adds the color of the lowest class, except where an earlier group has given a color.
Values add_colors(Values colors, const ColorNibbles& tables, std::size_t group, Values classes) {
  const Nibbles<Values> bits = nibbles_of(classes);
  const GroupTables low_and_high(tables.low, group);
  const Values low = look_up(low_and_high[0], bits.low);
  const Values color = vbslq_u8(vceqzq_u8(low), look_up(low_and_high[1], bits.high), low);
  return vbslq_u8(vceqzq_u8(colors), color, colors);
}

// Tables for the light level of a tile.
struct TileNibbles {
  const ChannelNibbles& first;
  const ChannelNibbles& second;
  const ChannelNibbles& third;
  const ColorNibbles& colors;
  std::size_t groups;

  TileNibbles(const NibbleTables& nibbles, const TileParameters& light)
      : first(nibbles.channel(0, light.level[0])),
        second(nibbles.channel(1, light.level[1])),
        third(nibbles.channel(2, light.level[2])),
        colors(nibbles.colors()),
        groups(nibbles.groups()) {}
};

// ORs `within` of all groups: if no bit is left, the pixel has no class.
Values within_any(const ChannelNibbles& channel) {
  Values any = vld1q_u8(channel.within[0].data());
  TOUCHLINE_UNROLL for (std::size_t group = 1; group < kClassGroups; ++group) {
    any = vorrq_u8(any, vld1q_u8(channel.within[group].data()));
  }
  return any;
}
struct Within {
  Values first, second, third;
  explicit Within(const TileNibbles& tables)
      : first(within_any(tables.first)), second(within_any(tables.second)), third(within_any(tables.third)) {}
};

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
// Intersects the background ranges of all tiles of a block. False: empty, which is impossible if all begin at 0.
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
// False: background by the high nibbles, as most tiles are that the background box does not reject.
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

  // For byte i of 48, its channel.
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

  // The first and second 16 bytes of a tile: consecutive in packed formats, luma and chroma in the others.
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

  // False: background by the high nibbles of chroma, as most tiles are that the background box does not reject.
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

// Classifies columns of a row: at least a tile, and whole pairs if pairs share chroma.
template <class Layout, bool kUnshaded>
class Span {
  using Background = typename Layout::Background;

 public:
  Span(const SpanTables& tables, const RowPixels& row, ColorId* colors)
      : tables_(tables),
        row_(row),
        colors_(colors),
        background_(background_words(*tables.tiles)),
        nibbles_(*tables.nibbles, *tables.tiles),
        within_(nibbles_) {}

  OccupiedWords classify(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t u = begin;
    if (u % kTile != 0) {
      classify_first(u);
      u = (u / kTile + 1) * kTile;
    }
    classify_tiles(u, end / kTile * kTile);
    if (end % kTile != 0) classify_last(end);
    return occupied_;
  }

 private:
  [[gnu::always_inline]] void classify_tiles(std::uint32_t u, std::uint32_t end) {
    while (u < end) {
      std::uint32_t stop = end;
      if (end - u >= kBlock) {
        if (tables_.has_background_box && is_background_block(u)) {
          TOUCHLINE_UNROLL for (std::uint32_t tile = 0; tile < kTilesOfBlock; ++tile) clear(u + tile * kTile);
          u += kBlock;
          continue;
        }
        stop = u + kBlock;
      }
      for (; u < stop; u += kTile) {
        if ((tables_.has_background_box && is_background_tile(u)) || !may_be_colored(u)) {
          clear(u);
          continue;
        }
        const Values found = colors_at(u, u);
        vst1q_u8(colors_ + u, found);
        note(found, u);
      }
    }
  }

  // Classifies the end of a tile, which begins at column u. kTile columns are in the span; later ones are overwritten.
  void classify_first(std::uint32_t u) {
    const Values found = colors_at(u, u);
    vst1q_u8(colors_ + u, found);
    note(vandq_u8(found, vcltq_u8(columns(), vdupq_n_u8(static_cast<std::uint8_t>(kTile - u % kTile)))), u);
  }

  // Classifies the begin of a tile, before column `end`. kTile columns are in the span; other tiles are already done.
  void classify_last(std::uint32_t end) {
    const std::uint32_t from = end - kTile;
    const Values here = vcgeq_u8(columns(), vdupq_n_u8(static_cast<std::uint8_t>(kTile - end % kTile)));
    const Values found = vandq_u8(here, colors_at(from, end - 1));
    vst1q_u8(colors_ + from, vbslq_u8(here, found, vld1q_u8(colors_ + from)));
    note(found, end - 1);
  }

  static Values columns() {
    static constexpr std::uint8_t kColumns[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return vld1q_u8(kColumns);
  }

  [[gnu::always_inline]] [[nodiscard]] bool is_background_block(std::uint32_t u) const {
    const RowPixels block = Layout::at(row_, u);
    if constexpr (kUnshaded) return background_.template holds<kTilesOfBlock>(block);
    BackgroundWords all;
    return background_words<Layout::kBackgroundFromZero>(tables_.tiles + u / kTile, all) &&
           Background(all).template holds<kTilesOfBlock>(block);
  }
  [[gnu::always_inline]] [[nodiscard]] bool is_background_tile(std::uint32_t u) const {
    const RowPixels tile = Layout::at(row_, u);
    if constexpr (kUnshaded) return background_.template holds<1>(tile);
    return Background(background_words(tables_.tiles[u / kTile])).template holds<1>(tile);
  }
  [[gnu::always_inline]] [[nodiscard]] bool may_be_colored(std::uint32_t u) const {
    const RowPixels tile = Layout::at(row_, u);
    if constexpr (kUnshaded) return Layout::may_be_colored(within_, tile);
    return Layout::may_be_colored(Within(TileNibbles(*tables_.nibbles, tables_.tiles[u / kTile])), tile);
  }
  // Colors of kTile columns that begin at `u`, with the light level of `light_column`.
  [[nodiscard]] Values colors_at(std::uint32_t u, std::uint32_t light_column) const {
    const RowPixels tile = Layout::at(row_, u);
    if constexpr (kUnshaded) return Layout::colors(nibbles_, tile);
    return Layout::colors(TileNibbles(*tables_.nibbles, tables_.tiles[light_column / kTile]), tile);
  }

  void clear(std::uint32_t u) { vst1q_u8(colors_ + u, vdupq_n_u8(kBackground)); }
  void note(Values found, std::uint32_t u) {
    if (!is_zero(found)) occupied_ |= OccupiedWords{1} << u / kOccupiedWordPixels;
  }

  // Copies, which stores to colors cannot change.
  const SpanTables tables_;
  const RowPixels row_;
  ColorId* const colors_;
  // Of the first tile; without a light map, of all tiles.
  const Background background_;
  const TileNibbles nibbles_;
  const Within within_;
  OccupiedWords occupied_ = 0;
};

template <class Layout>
OccupiedWords classify_light(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                             ColorId* colors) {
  return tables.unshaded ? Span<Layout, true>(tables, row, colors).classify(begin, end)
                         : Span<Layout, false>(tables, row, colors).classify(begin, end);
}
template <PixelFormat kFormat>
OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                            ColorId* colors) {
  if (end - begin < kTile) return portable_span_kernel(kFormat)(tables, row, begin, end, colors);
  if constexpr (info_of(kFormat).packing == Packing::kPacked32) {
    return classify_light<Packed32<kFormat>>(tables, row, begin, end, colors);
  } else if constexpr (info_of(kFormat).packing == Packing::kPacked24) {
    return tables.background_from_zero ? classify_light<Packed24<kFormat, true>>(tables, row, begin, end, colors)
                                       : classify_light<Packed24<kFormat, false>>(tables, row, begin, end, colors);
  } else {
    return classify_light<SharedChroma<kFormat>>(tables, row, begin, end, colors);
  }
}

struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<kFormat>;
};

}  // namespace
}  // namespace neon

SpanKernel neon_span_kernel(PixelFormat format) { return kernel_of_format<neon::Family>(format); }

}  // namespace touchline

#endif
