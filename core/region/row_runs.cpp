#include "core/region/row_runs.h"

#include <algorithm>
#include <bit>
#include <span>

namespace touchline {
namespace {

// Bits of each byte, 0 to 8, by halves.
WordPair bits_of_bytes(WordPair x) {
  x -= (x >> 1) & 0x5555555555555555u;
  x = (x & 0x3333333333333333u) + ((x >> 2) & 0x3333333333333333u);
  return (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}
// As many pairs as a row has can be added up before a byte is full.
static_assert((kMaxRowWords + 1) / kWordsOfPair * 8 < 256);
std::size_t sum_of_bytes(WordPair x) {
  constexpr std::uint64_t kEvenBytes = 0x00ff00ff00ff00ffu;
  x = (x & kEvenBytes) + ((x >> 8) & kEvenBytes);
  return static_cast<std::size_t>(((x[0] + x[1]) * 0x0001000100010001u) >> 48);
}

// Bit i of the result is bit i + pixels (i - pixels) of a row; `right` (`left`) holds the neighbors of the words.
WordPair from_right(WordPair words, WordPair right, std::size_t pixels) {
  return words >> pixels | right << (kPixelsOfWord - pixels);
}
WordPair from_left(WordPair words, WordPair left, std::size_t pixels) {
  return words << pixels | left >> (kPixelsOfWord - pixels);
}

}  // namespace

void forget_specks(const RowMasks& below, RowMasks& masks) {
  for (OccupiedWords words = masks.occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const std::uint64_t others = ~(masks.first[i] & masks.last[i]) | masks.like_above[i] | below.like_above[i];
    masks.first[i] &= others;
    masks.last[i] &= others;
  }
}

std::size_t count_runs(const RowMasks& masks, std::size_t words) {
  WordPair count = {};
  for (std::size_t i = 0; i < words; i += kWordsOfPair) count += bits_of_bytes(masks.first.pair(i));
  return sum_of_bytes(count);
}

std::size_t write_runs(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out) {
  Run* begun = out;
  Run* ended = out;
  for (OccupiedWords words = masks.occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const std::size_t base = i * kPixelsOfWord;
    for (std::uint64_t bits = masks.first[i]; bits != 0; bits &= bits - 1) {
      const std::size_t u = base + static_cast<std::size_t>(std::countr_zero(bits));
      *begun++ = {row, static_cast<std::uint16_t>(u), 0, colors.pixels()[u], kNoRun};
    }
    for (std::uint64_t bits = masks.last[i]; bits != 0; bits &= bits - 1) {
      (ended++)->end = static_cast<std::uint16_t>(base + static_cast<std::size_t>(std::countr_zero(bits)) + 1);
    }
  }
  return static_cast<std::size_t>(begun - out);
}

std::size_t RunChoice::count_longer(const RowMasks& masks, std::size_t words, std::size_t length) {
  WordPair count = {};
  for (std::size_t i = 0; i < words; i += kWordsOfPair) {
    const WordPair last = masks.last.pair(i), right = masks.last.pair(i + 1);
    WordPair ending = last;
    for (std::size_t pixels = 1; pixels < length; ++pixels) ending |= from_right(last, right, pixels);
    count += bits_of_bytes(masks.first.pair(i) & ~ending);
  }
  return sum_of_bytes(count);
}

void RunChoice::forget_up_to(std::size_t length, std::size_t words, RowMasks& masks) {
  std::uint64_t before = 0;  // the first pixels of the word on the left, as they were
  for (std::size_t i = 0; i < words; i += kWordsOfPair) {
    const WordPair first = masks.first.pair(i), left = {before, first[0]};
    const WordPair last = masks.last.pair(i), right = masks.last.pair(i + 1);
    WordPair ending = last, beginning = first;
    for (std::size_t pixels = 1; pixels < length; ++pixels) {
      ending |= from_right(last, right, pixels);
      beginning |= from_left(first, left, pixels);
    }
    before = first[1];
    masks.first.set_pair(i, first & ~ending);
    masks.last.set_pair(i, last & ~beginning);
  }
}

std::size_t RunChoice::write_longest(RowMasks& masks, const ColorRow& colors, std::size_t words, std::uint16_t row,
                                     std::size_t limit, Run* out) {
  std::size_t count = count_longer(masks, words, short_ones_);
  if (count > limit) {
    while (count > limit && short_ones_ + 1 < kListed) count = count_longer(masks, words, ++short_ones_);
  } else {
    while (short_ones_ > 1) {
      const std::size_t with_more = count_longer(masks, words, short_ones_ - 1);
      if (with_more > limit) break;
      count = with_more;
      --short_ones_;
    }
  }
  forget_up_to(short_ones_, words, masks);
  if (count <= limit) return write_runs(masks, colors, row, out);

  write_runs(masks, colors, row, listed_.data());
  const auto length_of = [](const Run& run) {
    return std::min<std::size_t>(static_cast<std::size_t>(run.end - run.begin), kLongest);
  };
  std::array<std::uint16_t, kLongest + 1> of_length{};
  const std::span<const Run> listed(listed_.data(), count);
  for (const Run& run : listed) ++of_length[length_of(run)];
  std::size_t least = kListed;
  for (; least < kLongest && count > limit; ++least) count -= of_length[least];
  std::size_t written = 0;
  for (const Run& run : listed) {
    out[written] = run;  // to be overwritten unless it is counted
    written += static_cast<std::size_t>(length_of(run) >= least) & static_cast<std::size_t>(written < limit);
  }
  return written;
}

}  // namespace touchline
