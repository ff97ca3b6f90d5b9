#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

// A few more than a row can have may be written, and do not count.
using Columns = std::array<std::uint16_t, kMaxRowWords * kPixelsOfWord + 8>;

/// Runs of neighboring rows that share a column and their color, numbered in their rows from 0 on.
struct Contact {
  std::uint16_t above = 0, below = 0;
};
// At most one a column.
using Contacts = std::array<Contact, kMaxRowWords * kPixelsOfWord + 8>;

/// Work on the bits of a row, in the instructions that go with a color kernel. All sets do the same.
struct RowBits {
  std::size_t (*count)(const PixelBits& bits, std::size_t words);
  /// A bit of `ending` says that the pixel's run ends less than some pixels further to the right, as many as `pixels`
  /// or more. (Where there is no run it says nothing.) Adds `pixels`, 1 to 63, and returns how many runs are longer.
  std::size_t (*widen)(const PixelBits& ending, std::size_t pixels, const PixelBits& first, std::size_t words,
                       PixelBits& wider);
  /// The columns of the bits from left to right; words that are not occupied have none. Returns how many.
  std::size_t (*list)(const PixelBits& bits, OccupiedWords occupied, Columns& columns);
  /// The contacts of a row's runs with those of the row above, from left to right. Returns how many.
  std::size_t (*list_contacts)(const RowMasks& above, const RowMasks& row, Contacts& contacts);
};

const RowBits& row_bits(KernelChoice kernel);

}  // namespace touchline
