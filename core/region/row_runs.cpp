#include "core/region/row_runs.h"

#include <algorithm>
#include <bit>

namespace touchline {
namespace {

// Keeps only the leftmost `count` of the long runs: a run is long if its begin is not in `ending`.
void keep_leftmost_long_runs(std::size_t count, const PixelBits& ending, std::size_t words, PixelBits& first) {
  for (std::size_t i = 0; i < words; ++i) {
    std::uint64_t others = first[i] & ~ending[i];
    for (; count > 0 && others != 0; --count) others &= others - 1;
    first[i] &= ~others;
  }
}

// Removes the short runs, whose begins are in `ending`.
void remove_short_runs(const PixelBits& ending, std::size_t words, RowMasks& masks) {
  masks.occupied = 0;
  masks.is_cut = true;
  bool borrow = false;
  for (std::size_t i = 0; i < words; ++i) {
    const std::uint64_t first = masks.first[i] & ~ending[i], last = masks.last[i];
    // Subtracting a run's first bit from its last bit sets the bits from the first to the one before the last, and
    // clears the last (borrow).
    std::uint64_t between = 0;
    const bool borrows = __builtin_sub_overflow(last, first, &between);
    borrow = __builtin_sub_overflow(between, std::uint64_t{borrow}, &between) || borrows;
    masks.first[i] = first;
    masks.last[i] = last & ~between;
    masks.inside[i] = last ^ between;
    masks.removed_like_above[i] = masks.like_above[i] & ~masks.inside[i];
    masks.like_above[i] &= masks.inside[i];
    masks.occupied |= OccupiedWords{masks.inside[i] != 0} << i;
  }
}

}  // namespace

void remove_isolated_pixels(const RowMasks& below, RowMasks& masks) {
  for (OccupiedWords words = masks.occupied; words != 0; words &= words - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(words));
    const std::uint64_t others = ~(masks.first[i] & masks.last[i]) | masks.like_above[i] | below.like_above[i];
    masks.first[i] &= others;
    masks.last[i] &= others;
  }
}

std::size_t RunWriter::cut(RowMasks& masks, std::size_t limit) {
  std::size_t nibble = 0, longer = widen(masks.last, 1, masks.first, words_, endings_[0]);
  while (longer > limit && nibble + 1 < endings_.size()) {
    longer = widen(endings_[nibble], std::size_t{2} << nibble, masks.first, words_, endings_[nibble + 1]);
    ++nibble;
  }
  const PixelBits* ending = &endings_[nibble];
  if (nibble > 0) {
    const std::size_t longer_than_less =
        widen(endings_[nibble - 1], std::size_t{1} << (nibble - 1), masks.first, words_, halfway_);
    if (longer_than_less <= limit) {
      longer = longer_than_less;
      ending = &halfway_;
    }
  }
  if (longer > limit) keep_leftmost_long_runs(limit, *ending, words_, masks.first);
  remove_short_runs(*ending, words_, masks);
  return std::min(longer, limit);
}

std::size_t RunWriter::write(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out) {
  const std::size_t count = list_columns(masks.first, masks.occupied, columns_);
  list_columns(masks.last, masks.occupied, last_columns_);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint16_t begin = columns_[k];
    out[k] = {row, begin, static_cast<std::uint16_t>(last_columns_[k] + 1), colors.pixels()[begin], kNoRun};
  }
  return count;
}

std::span<const Contact> RunWriter::find_contacts(const RowMasks& above, RowMasks& masks) {
  if (above.is_cut) {
    for (OccupiedWords words = masks.occupied; words != 0; words &= words - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(words));
      masks.like_above[i] &= above.inside[i];
    }
  }
  return {contacts_.data(), list_contacts(above, masks, contacts_)};
}

}  // namespace touchline
