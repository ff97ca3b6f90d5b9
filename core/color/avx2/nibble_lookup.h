// Table look-ups with a byte shuffle.
#pragma once

#if defined(__x86_64__)

#include <immintrin.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/color/nibble_tables.h"
#include "core/color/span_kernel.h"
#include "core/cpu.h"

namespace touchline::avx2 {

// A byte shuffle looks up within 16 bytes, so each half of a register holds one tile, which has tables of its own.
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
// Returns 1 or 0 as a number, to avoid a branch.
TOUCHLINE_AVX2_INLINE std::uint64_t is_zero(__m256i value) {
  return static_cast<std::uint64_t>(_mm256_testz_si256(value, value));
}
TOUCHLINE_AVX2_INLINE std::uint64_t is_zero(__m128i value) {
  return static_cast<std::uint64_t>(_mm_testz_si128(value, value));
}
// Bit i: the lower half of register i is zero. Bit i + 4: the upper half is zero. This takes half the instructions of
// eight separate tests.
TOUCHLINE_AVX2_INLINE std::uint64_t zero_halves(__m256i a, __m256i b, __m256i c, __m256i d) {
  // ORs each half down to eight bytes, then to four.
  const __m256 ab = _mm256_castsi256_ps(_mm256_or_si256(_mm256_unpacklo_epi64(a, b), _mm256_unpackhi_epi64(a, b))),
               cd = _mm256_castsi256_ps(_mm256_or_si256(_mm256_unpacklo_epi64(c, d), _mm256_unpackhi_epi64(c, d)));
  const __m256 abcd = _mm256_or_ps(_mm256_shuffle_ps(ab, cd, 0b10001000), _mm256_shuffle_ps(ab, cd, 0b11011101));
  const __m256i is_zero = _mm256_cmpeq_epi32(_mm256_castps_si256(abcd), _mm256_setzero_si256());
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(is_zero)));
}
// Bits 0 and 1: the lower halves of a and b are zero. Bits 2 and 3: the upper halves.
TOUCHLINE_AVX2_INLINE std::uint64_t zero_halves(__m256i a, __m256i b) {
  const __m256i ab = _mm256_or_si256(_mm256_unpacklo_epi64(a, b), _mm256_unpackhi_epi64(a, b)),
                is_zero = _mm256_cmpeq_epi64(ab, _mm256_setzero_si256());
  return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_castsi256_pd(is_zero)));
}

// Values of one block, or of two blocks that share their tables. Sharing helps because loading tables is half of the
// work.
struct OneBlock {
  __m256i first;
};
struct TwoBlocks {
  __m256i first, second;
};
TOUCHLINE_AVX2_INLINE OneBlock and_of(const OneBlock& a, const OneBlock& b) {
  return {_mm256_and_si256(a.first, b.first)};
}
TOUCHLINE_AVX2_INLINE TwoBlocks and_of(const TwoBlocks& a, const TwoBlocks& b) {
  return {_mm256_and_si256(a.first, b.first), _mm256_and_si256(a.second, b.second)};
}
TOUCHLINE_AVX2_INLINE OneBlock or_of(const OneBlock& a, const OneBlock& b) {
  return {_mm256_or_si256(a.first, b.first)};
}
TOUCHLINE_AVX2_INLINE TwoBlocks or_of(const TwoBlocks& a, const TwoBlocks& b) {
  return {_mm256_or_si256(a.first, b.first), _mm256_or_si256(a.second, b.second)};
}
TOUCHLINE_AVX2_INLINE OneBlock shuffle(__m256i table, const OneBlock& nibble) {
  return {_mm256_shuffle_epi8(table, nibble.first)};
}
TOUCHLINE_AVX2_INLINE TwoBlocks shuffle(__m256i table, const TwoBlocks& nibble) {
  return {_mm256_shuffle_epi8(table, nibble.first), _mm256_shuffle_epi8(table, nibble.second)};
}
// Returns `a` where it is not zero, else `b`.
TOUCHLINE_AVX2_INLINE __m256i first_of(__m256i a, __m256i b) {
  return _mm256_blendv_epi8(a, b, _mm256_cmpeq_epi8(a, _mm256_setzero_si256()));
}
TOUCHLINE_AVX2_INLINE __m128i first_of(__m128i a, __m128i b) {
  return _mm_blendv_epi8(a, b, _mm_cmpeq_epi8(a, _mm_setzero_si128()));
}
TOUCHLINE_AVX2_INLINE OneBlock first_of(const OneBlock& a, const OneBlock& b) { return {first_of(a.first, b.first)}; }
TOUCHLINE_AVX2_INLINE TwoBlocks first_of(const TwoBlocks& a, const TwoBlocks& b) {
  return {first_of(a.first, b.first), first_of(a.second, b.second)};
}

// Without these barriers, compilers do all look-ups of a group first and run out of registers for the results.
TOUCHLINE_AVX2_INLINE void optimization_barrier(OneBlock& values) { asm volatile("" : "+x"(values.first)); }
TOUCHLINE_AVX2_INLINE void optimization_barrier(TwoBlocks& values) {
  asm volatile("" : "+x"(values.first), "+x"(values.second));
}

TOUCHLINE_AVX2_INLINE __m256i low_nibble(__m256i values) { return _mm256_and_si256(values, _mm256_set1_epi8(15)); }
TOUCHLINE_AVX2_INLINE __m256i high_nibble(__m256i values) { return low_nibble(_mm256_srli_epi16(values, 4)); }

// High and low nibbles of values.
template <class Values>
struct Nibbles {
  Values high, low;
};
TOUCHLINE_AVX2_INLINE Nibbles<OneBlock> nibbles_of(const OneBlock& values) {
  return {{high_nibble(values.first)}, {low_nibble(values.first)}};
}
TOUCHLINE_AVX2_INLINE Nibbles<TwoBlocks> nibbles_of(const TwoBlocks& values) {
  return {{high_nibble(values.first), high_nibble(values.second)},
          {low_nibble(values.first), low_nibble(values.second)}};
}

// Which groups' tables a register holds.
enum class GroupsInRegister {
  kOne,  // the same group in both halves, for the pixels of a block
  kTwo,  // a group and the next one, for the pixels of a tile in both halves
};

template <GroupsInRegister kGroups, class Values>
TOUCHLINE_AVX2_INLINE Values look_up(const GroupLookups& tables, std::size_t group, const Values& nibble) {
  const std::uint8_t* bytes = tables.data()->data() + sizeof(NibbleLookup) * group;
  return shuffle(kGroups == GroupsInRegister::kOne ? in_both_halves(bytes) : load(bytes), nibble);
}

// Values and tables of a channel.
template <class Values>
struct Channel {
  Nibbles<Values> value;
  const ChannelNibbles* tables;
};
template <class Values>
struct Channels {
  Channel<Values> first, second, third;
};

// Coarse test: returns the classes of the group whose three intervals contain the high nibbles of the values.
template <GroupsInRegister kGroups, class Values>
TOUCHLINE_AVX2_INLINE Values coarse_classes(const Channels<Values>& channels, std::size_t group) {
  return and_of(look_up<kGroups>(channels.first.tables->within, group, channels.first.value.high),
                and_of(look_up<kGroups>(channels.second.tables->within, group, channels.second.value.high),
                       look_up<kGroups>(channels.third.tables->within, group, channels.third.value.high)));
}

// Exact test: keeps the classes to which the values of a channel belong, one byte per value.
template <GroupsInRegister kGroups, class Values>
TOUCHLINE_AVX2_INLINE void narrow(Values& classes, const Channel<Values>& channel, std::size_t group) {
  const ChannelNibbles& tables = *channel.tables;
  const Nibbles<Values>& value = channel.value;
  classes = and_of(classes, or_of(look_up<kGroups>(tables.above_first, group, value.high),
                                  look_up<kGroups>(tables.from_first, group, value.low)));
  optimization_barrier(classes);
  classes = and_of(classes, or_of(look_up<kGroups>(tables.below_last, group, value.high),
                                  look_up<kGroups>(tables.to_last, group, value.low)));
  optimization_barrier(classes);
}

// Returns the color of the lowest class of the group, or of each of the two groups.
template <GroupsInRegister kGroups, class Values>
TOUCHLINE_AVX2_INLINE Values colors_in(const ColorNibbles& colors, const Channels<Values>& channels,
                                       std::size_t group) {
  Values classes = coarse_classes<kGroups>(channels, group);
  optimization_barrier(classes);
  narrow<kGroups>(classes, channels.first, group);
  narrow<kGroups>(classes, channels.second, group);
  narrow<kGroups>(classes, channels.third, group);
  const Nibbles<Values> bits = nibbles_of(classes);
  return first_of(look_up<kGroups>(colors.low, group, bits.low), look_up<kGroups>(colors.high, group, bits.high));
}

}  // namespace touchline::avx2

#endif
