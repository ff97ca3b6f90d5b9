#include "core/region/row_runs.h"

#include <algorithm>
#include <bit>

namespace touchline {
namespace {

// The last pixels of the runs of which `any` has one pixel each.
void find_ends(const PixelBits& any, const PixelBits& last, std::size_t words, PixelBits& ends) {
  std::uint64_t borrow = 0;
  for (std::size_t i = 0; i < words; ++i) {
    // Taking that pixel away from the last ones borrows, and clears, the first of these that is not further left.
    const std::uint64_t from = last[i], without = from - any[i];
    ends[i] = from & ~(without - borrow);
    borrow = static_cast<std::uint64_t>(from < any[i]) | static_cast<std::uint64_t>(without < borrow);
  }
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

void RunWriter::configure(KernelChoice kernel, std::size_t words) {
  bits_ = &row_bits(kernel);
  words_ = words;
}

void RunWriter::build(const ColorRow& colors, std::uint16_t row, std::size_t behind_first, std::size_t count,
                      Run* out) const {
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t u = columns_[k];
    out[k] = {row, static_cast<std::uint16_t>(u - behind_first), static_cast<std::uint16_t>(last_columns_[k] + 1),
              colors.pixels()[u], kNoRun};
  }
}

std::size_t RunWriter::write_all(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out) {
  const std::size_t count = bits_->list(masks.first, masks.occupied, columns_);
  bits_->list(masks.last, masks.occupied, last_columns_);
  build(colors, row, 0, count, out);
  return count;
}

std::size_t RunWriter::write_longest(const RowMasks& masks, const ColorRow& colors, std::uint16_t row,
                                     std::size_t limit, Run* out) {
  // The greatest length that too many runs exceed, by its binary digits: first how many it has. Neighboring rows are
  // often alike, so that a guess at what follows is better than waiting for a count.
  const auto ending = [&](std::size_t digit) -> const PixelBits& {
    return digit == 0 ? masks.last : endings_[digit - 1];
  };
  constexpr std::size_t kDigits = std::bit_width(kLongest - 1);
  static_assert(std::tuple_size_v<decltype(endings_)> + 1 == kDigits);
  std::size_t digits = 0, longer = bits_->advance(masks.first, masks.last, 1, words_, behind_[0]);
  while (longer > limit && ++digits < kDigits) {
    longer =
        bits_->widen(ending(digits - 1), std::size_t{1} << (digits - 1), masks.first, words_, endings_[digits - 1]);
  }
  const PixelBits* behind = &masks.first;
  std::size_t length = 0, turn = 0;
  for (std::size_t digit = digits; digit-- > 0;) {
    const std::size_t pixels = std::size_t{1} << digit;
    longer = bits_->advance(*behind, ending(digit), pixels, words_, behind_[turn]);
    if (digit + 1 < digits && longer <= limit) [[unlikely]]
      continue;
    behind = &behind_[turn];
    length += pixels;
    turn ^= 1;
  }
  if (length + 1 < kLongest) {
    if (length > 0) bits_->advance(*behind, masks.last, 1, words_, behind_[turn]);
    behind = &behind_[turn];
    ++length;
  }
  find_ends(*behind, masks.last, words_, ends_);
  // Few are left, in few words.
  const std::size_t count = std::min(limit, bits_->list(*behind, bits_->find_words(*behind, words_), columns_));
  bits_->list(ends_, bits_->find_words(ends_, words_), last_columns_);
  build(colors, row, length, count, out);
  return count;
}

}  // namespace touchline
