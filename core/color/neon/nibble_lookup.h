#pragma once

#if defined(__aarch64__)

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "core/color/nibble_tables.h"
#include "core/color/span_kernel.h"

// Table look-ups with a byte shuffle, for 16 pixels or 8 pixel pairs at a time.
namespace touchline::neon {
namespace {  // internal linkage, because only span_kernel.cpp includes this file

// A tile fills a register. The background test takes four tiles; if it fails, tiles are tested one by one.
constexpr std::uint32_t kTile = kTileWidth, kTilesOfBlock = 4, kBlock = kTilesOfBlock * kTile;
static_assert(kTile == 16 && kBackground == 0);

using Values = uint8x16_t;  // values of a tile's pixels
using PairValues = uint8x8_t;

// Unrolls short loops over tiles and channels, so that the arrays stay in registers.
#define TOUCHLINE_UNROLL _Pragma("GCC unroll 4")

bool is_zero(Values value) {
  const uint32x4_t words = vreinterpretq_u32_u8(value);
  return vgetq_lane_u64(vreinterpretq_u64_u32(vpmaxq_u32(words, words)), 0) == 0;
}
bool is_zero(PairValues value) { return vget_lane_u64(vreinterpret_u64_u8(value), 0) == 0; }

// Look-ups for 16 pixels and for 8 pairs. A Cortex-A72 takes a third of the time for half a register.
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

// Reaches the tables of a group by their distance from the first table. A single address then serves all; otherwise gcc
// 12 computes each address.
class GroupTables {
 public:
  GroupTables(const GroupLookups& first, std::size_t group) : at_(first[group].data()) { asm("" : "+r"(at_)); }
  [[nodiscard]] const std::uint8_t* operator[](std::size_t number) const { return at_ + sizeof(GroupLookups) * number; }

 private:
  const std::uint8_t* at_;
};
static_assert(offsetof(ChannelNibbles, to_last) == 4 * sizeof(GroupLookups));

// Returns the classes of the group to which the values of a channel belong, one byte per value.
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

// ORs `within` of all groups; if no bit is set, the pixel has no class.
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

}  // namespace
}  // namespace touchline::neon

#endif
