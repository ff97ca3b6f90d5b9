#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

// Functions may write a few entries beyond the last valid one; callers ignore them.
using Columns = std::array<std::uint16_t, kMaxRowWords * kPixelsOfWord + 8>;

/// Contact of two runs of one color in neighboring rows: they share at least one column. Runs are numbered in their
/// rows, from 0.
struct Contact {
  std::uint16_t above = 0, below = 0;
};
// At most one per column.
using Contacts = std::array<Contact, kMaxRowWords * kPixelsOfWord + 8>;

// Counts the bits of a row.

std::size_t count_bits(const PixelBits& bits, std::size_t words);

/// Input: in `ending`, a bit is set if the pixel's run ends less than n pixels to the right, with n >= `pixels`. (Bits
/// outside of runs have no meaning.) Writes to `wider` the bits for n + `pixels`; `pixels` is 1 to 63. Returns the
/// number of runs that are longer.
std::size_t widen(const PixelBits& ending, std::size_t pixels, const PixelBits& first, std::size_t words,
                  PixelBits& wider);

/// Lists the columns of the bits from left to right and returns their number. Words that are not in `occupied` have no
/// bits.
std::size_t list_columns(const PixelBits& bits, OccupiedWords occupied, Columns& columns);

/// Lists the contacts between the runs of two rows from left to right and returns their number.
std::size_t list_contacts(const RowMasks& above, const RowMasks& row, Contacts& contacts);

}  // namespace touchline
