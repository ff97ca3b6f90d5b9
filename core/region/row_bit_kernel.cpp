#include "core/region/row_bit_kernel.h"

#include <algorithm>
#include <bit>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace touchline {
namespace {

// --- Two words at a time --------------------------------------------------------------------------------------------

// Counts the bits of each byte, 0 to 8, by halves.
WordPair bits_of_bytes(WordPair x) {
  x -= (x >> 1) & 0x5555555555555555u;
  x = (x & 0x3333333333333333u) + ((x >> 2) & 0x3333333333333333u);
  return (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}
// All pairs of a row can be added before a byte overflows.
static_assert((kMaxRowWords + 1) / kWordsOfPair * 8 < 256);
std::size_t sum_of_bytes(WordPair x) {
  constexpr std::uint64_t kEvenBytes = 0x00ff00ff00ff00ffu;
  x = (x & kEvenBytes) + ((x >> 8) & kEvenBytes);
  return static_cast<std::size_t>(((x[0] + x[1]) * 0x0001000100010001u) >> 48);
}

std::size_t count_by_pairs(const PixelBits& bits, std::size_t words) {
  WordPair count = {};
  for (std::size_t i = 0; i < words; i += kWordsOfPair) count += bits_of_bytes(bits.pair(i));
  return sum_of_bytes(count);
}

std::size_t widen_by_pairs(const PixelBits& ending, std::size_t pixels, const PixelBits& first, std::size_t words,
                           PixelBits& wider) {
  WordPair count = {}, right = {};
  for (std::size_t i = (words + 1) / kWordsOfPair * kWordsOfPair; i > 0;) {
    i -= kWordsOfPair;
    const WordPair here = ending.pair(i), neighbors = {here[1], right[0]};
    const WordPair both = here | here >> pixels | neighbors << (kPixelsOfWord - pixels);
    right = here;
    wider.set_pair(i, both);
    count += bits_of_bytes(first.pair(i) & ~both);
  }
  return sum_of_bytes(count);
}

[[gnu::always_inline]] inline std::uint16_t column_of(std::size_t base, std::uint64_t word) {
  return static_cast<std::uint16_t>(base + static_cast<std::size_t>(std::countr_zero(word)));
}
[[gnu::always_inline]] inline std::size_t list_bits(const PixelBits& bits, OccupiedWords occupied, Columns& columns) {
  std::uint16_t* next = columns.data();
  for (; occupied != 0; occupied &= occupied - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(occupied));
    const std::size_t base = i * kPixelsOfWord;
    // Most words have up to three bits, at random. Three entries are always written, and only existing bits are
    // counted: a mispredicted branch would cost more.
    const std::uint64_t word = bits[i], second = word & (word - 1), third = second & (second - 1);
    next[0] = column_of(base, word);
    next[1] = column_of(base, second);
    next[2] = column_of(base, third);
    next += static_cast<std::size_t>(word != 0) + static_cast<std::size_t>(second != 0) +
            static_cast<std::size_t>(third != 0);
    for (std::uint64_t others = third & (third - 1); others != 0; others &= others - 1) {
      *next++ = column_of(base, others);
    }
  }
  return static_cast<std::size_t>(next - columns.data());
}
std::size_t list_portably(const PixelBits& bits, OccupiedWords occupied, Columns& columns) {
  return list_bits(bits, occupied, columns);
}

// Number of `ends` before the lowest of `bits`.
[[gnu::always_inline]] inline std::uint16_t number_of(std::size_t base, std::uint64_t ends, std::uint64_t bits) {
  return static_cast<std::uint16_t>(base + static_cast<std::size_t>(std::popcount(ends & ~bits & (bits - 1))));
}
[[gnu::always_inline]] inline std::size_t list_contacts(const RowMasks& above, const RowMasks& row,
                                                        Contacts& contacts) {
  Contact* next = contacts.data();
  std::size_t runs_above = 0, runs = 0;  // number of runs that end in earlier words
  for (OccupiedWords words = above.occupied | row.occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const std::uint64_t ends_above = above.last[i], ends = row.last[i];
    const auto contact_at = [&](std::uint64_t begins) {
      return Contact{number_of(runs_above, ends_above, begins), number_of(runs, ends, begins)};
    };
    // Three entries are always written, as in list_bits().
    const std::uint64_t begins = row.like_above[i] & (row.first[i] | above.first[i]), second = begins & (begins - 1),
                        third = second & (second - 1);
    next[0] = contact_at(begins);
    next[1] = contact_at(second);
    next[2] = contact_at(third);
    next += static_cast<std::size_t>(begins != 0) + static_cast<std::size_t>(second != 0) +
            static_cast<std::size_t>(third != 0);
    for (std::uint64_t others = third & (third - 1); others != 0; others &= others - 1) *next++ = contact_at(others);
    runs_above += static_cast<std::size_t>(std::popcount(ends_above));
    runs += static_cast<std::size_t>(std::popcount(ends));
  }
  return static_cast<std::size_t>(next - contacts.data());
}
std::size_t list_contacts_portably(const RowMasks& above, const RowMasks& row, Contacts& contacts) {
  return list_contacts(above, row, contacts);
}

constexpr RowBitKernel portable_row_bit_kernel = {count_by_pairs, widen_by_pairs, list_portably,
                                                  list_contacts_portably};

#if defined(__x86_64__)

// --- AVX2: four words -----------------------------------------------------------------------------------------------

constexpr std::size_t kQuad = 4;

TOUCHLINE_AVX2_INLINE __m256i load_quad(const PixelBits& bits, std::size_t i) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(&bits[i]));
}
TOUCHLINE_AVX2_INLINE void store_quad(PixelBits& bits, std::size_t i, __m256i words) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(&bits[i]), words);
}

TOUCHLINE_AVX2 std::size_t count_avx2(const PixelBits& bits, std::size_t words) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < words; ++i) count += static_cast<std::size_t>(std::popcount(bits[i]));
  return count;
}

// Counts the bits of each byte.
TOUCHLINE_AVX2_INLINE __m256i bits_of_bytes(__m256i words) {
  const __m256i nibble = _mm256_set1_epi8(15);
  const __m256i bits_of_nibble = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                                  0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  return _mm256_add_epi8(_mm256_shuffle_epi8(bits_of_nibble, _mm256_and_si256(words, nibble)),
                         _mm256_shuffle_epi8(bits_of_nibble, _mm256_and_si256(_mm256_srli_epi16(words, 4), nibble)));
}
TOUCHLINE_AVX2_INLINE std::size_t sum_of_bytes(__m256i bytes) {
  const __m256i sums = _mm256_sad_epu8(bytes, _mm256_setzero_si256());
  const __m128i pair = _mm_add_epi64(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
  return static_cast<std::size_t>(_mm_cvtsi128_si64(pair) + _mm_extract_epi64(pair, 1));
}

TOUCHLINE_AVX2 std::size_t widen_avx2(const PixelBits& ending, std::size_t pixels, const PixelBits& first,
                                      std::size_t words, PixelBits& wider) {
  const __m128i by = _mm_cvtsi64_si128(static_cast<long long>(pixels)),
                rest = _mm_cvtsi64_si128(static_cast<long long>(kPixelsOfWord - pixels));
  __m256i count = _mm256_setzero_si256(),
          turned = count;  // the quad to the right, with its words moved one place to the left
  for (std::size_t i = (words + kQuad - 1) / kQuad * kQuad; i > 0;) {
    i -= kQuad;
    const __m256i here = load_quad(ending, i), left = _mm256_permute4x64_epi64(here, 0b00111001);
    const __m256i neighbors = _mm256_blend_epi32(left, turned, 0b11000000);
    turned = left;
    const __m256i both =
        _mm256_or_si256(here, _mm256_or_si256(_mm256_srl_epi64(here, by), _mm256_sll_epi64(neighbors, rest)));
    store_quad(wider, i, both);
    count = _mm256_add_epi8(count, bits_of_bytes(_mm256_andnot_si256(both, load_quad(first, i))));
  }
  return sum_of_bytes(count);
}

TOUCHLINE_AVX2 std::size_t list_avx2(const PixelBits& bits, OccupiedWords occupied, Columns& columns) {
  return list_bits(bits, occupied, columns);
}

TOUCHLINE_AVX2 std::size_t list_contacts_avx2(const RowMasks& above, const RowMasks& row, Contacts& contacts) {
  return list_contacts(above, row, contacts);
}

constexpr RowBitKernel avx2_row_bit_kernel = {count_avx2, widen_avx2, list_avx2, list_contacts_avx2};

#endif

}  // namespace

const RowBitKernel& row_bit_kernel(KernelChoice kernel) {
  switch (kernel) {
#define TOUCHLINE_SET(family, set, word, features, span_kernel, row_masks, row_bit_kernel, ...) \
  TOUCHLINE_ON_##family(case KernelChoice::set : return row_bit_kernel;)
    TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)  // NOLINT(bugprone-branch-clone): sets may share a function
#undef TOUCHLINE_SET
    default:
      return portable_row_bit_kernel;
  }
}

}  // namespace touchline
