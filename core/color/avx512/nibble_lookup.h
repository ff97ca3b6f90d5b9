#pragma once

#if defined(__x86_64__)

#include <immintrin.h>

#include <cstddef>

#include "core/color/avx512/shaded_row.h"
#include "core/color/nibble_tables.h"

// Table look-ups with a byte shuffle, 64 values at a time.
namespace touchline::avx512 {
namespace {  // internal linkage, because only span_kernel.cpp includes this file

TOUCHLINE_TARGET_INLINE __m512i or_of(__m512i a, __m512i b, __m512i c) {
  return _mm512_ternarylogic_epi64(a, b, c, 0b11111110);
}
TOUCHLINE_TARGET_INLINE __m512i and_of(__m512i a, __m512i b, __m512i c) {
  return _mm512_ternarylogic_epi64(a, b, c, 0b10000000);
}
TOUCHLINE_TARGET_INLINE __m128i load_table(const NibbleLookup& table) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(table.data()));
}

// Nibbles of a channel's values, and the channel's tables.
struct Channel {
  __m512i high, low;
  const ChannelNibbles* nibbles;
};
struct Channels {
  Channel first, second, third;
};

TOUCHLINE_TARGET_INLINE __m512i high_nibble(__m512i values) {
  return _mm512_and_si512(_mm512_srli_epi16(values, 4), _mm512_set1_epi8(15));
}
TOUCHLINE_TARGET_INLINE __m512i low_nibble(__m512i values) { return _mm512_and_si512(values, _mm512_set1_epi8(15)); }

TOUCHLINE_TARGET_INLINE __m512i look_up(const NibbleLookup& table, __m512i nibbles) {
  return _mm512_shuffle_epi8(_mm512_maskz_broadcast_i32x4(0xffff, load_table(table)), nibbles);
}

TOUCHLINE_TARGET_INLINE __m512i coarse_classes(const Channel& channel, std::size_t group) {
  return look_up(channel.nibbles->within[group], channel.high);
}
// Coarse test: classes of the group whose three intervals contain the high nibbles of the values.
TOUCHLINE_TARGET_INLINE __m512i coarse_classes(const Channels& channels, std::size_t group) {
  return and_of(coarse_classes(channels.first, group), coarse_classes(channels.second, group),
                coarse_classes(channels.third, group));
}

// Exact test: keeps those of the classes `near` to which the values of a channel belong, one byte per value.
TOUCHLINE_TARGET_INLINE __m512i classes_of(const Channel& channel, std::size_t group, __m512i near) {
  const ChannelNibbles& tables = *channel.nibbles;
  const __m512i from =
      _mm512_or_si512(look_up(tables.above_first[group], channel.high), look_up(tables.from_first[group], channel.low));
  const __m512i to =
      _mm512_or_si512(look_up(tables.below_last[group], channel.high), look_up(tables.to_last[group], channel.low));
  return and_of(from, to, near);
}

// Adds the color of the lowest class, except where an earlier group has given a color.
TOUCHLINE_TARGET_INLINE __m512i add_colors(__m512i colors, const ColorNibbles& tables, std::size_t group,
                                           __m512i classes) {
  const __m512i low = look_up(tables.low[group], low_nibble(classes)),
                high = look_up(tables.high[group], high_nibble(classes));
  const __m512i color = _mm512_mask_mov_epi8(low, _mm512_testn_epi8_mask(low, low), high);
  return _mm512_mask_mov_epi8(colors, _mm512_testn_epi8_mask(colors, colors), color);
}

}  // namespace
}  // namespace touchline::avx512

#endif
