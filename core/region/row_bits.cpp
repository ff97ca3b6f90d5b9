#include "core/region/row_bits.h"

#include <bit>

namespace touchline {
namespace {

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

std::uint16_t column_of(std::size_t base, std::uint64_t word) {
  return static_cast<std::uint16_t>(base + static_cast<std::size_t>(std::countr_zero(word)));
}
// Returns how many of `ends` lie before the lowest of `bits`.
std::uint16_t number_of(std::size_t base, std::uint64_t ends, std::uint64_t bits) {
  return static_cast<std::uint16_t>(base + static_cast<std::size_t>(std::popcount(ends & ~bits & (bits - 1))));
}

}  // namespace

std::size_t count_bits(const PixelBits& bits, std::size_t words) {
  WordPair count = {};
  for (std::size_t i = 0; i < words; i += kWordsOfPair) count += bits_of_bytes(bits.pair(i));
  return sum_of_bytes(count);
}

std::size_t widen(const PixelBits& ending, std::size_t pixels, const PixelBits& first, std::size_t words,
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

std::size_t list_columns(const PixelBits& bits, OccupiedWords occupied, Columns& columns) {
  std::uint16_t* next = columns.data();
  for (; occupied != 0; occupied &= occupied - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(occupied));
    const std::size_t base = i * kPixelsOfWord;
    // Most words have up to three bits, at random. Three entries are always written, and only existing bits are
    // counted, because a mispredicted branch would cost more.
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

std::size_t list_contacts(const RowMasks& above, const RowMasks& row, Contacts& contacts) {
  Contact* next = contacts.data();
  std::size_t runs_above = 0, runs = 0;  // number of runs that end in earlier words
  for (OccupiedWords words = above.occupied | row.occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const std::uint64_t ends_above = above.last[i], ends = row.last[i];
    const auto contact_at = [&](std::uint64_t begins) {
      return Contact{number_of(runs_above, ends_above, begins), number_of(runs, ends, begins)};
    };
    // Three entries are always written, for the reason given in list_columns().
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

}  // namespace touchline
