#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

// A few more than a row can have may be written, and do not count.
using Columns = std::array<std::uint16_t, kMaxRowWords * kPixelsOfWord + 8>;

/// Work on the bits of a row, in the instructions that go with a color kernel. All sets do the same.
struct RowBits {
  std::size_t (*count)(const PixelBits& bits, std::size_t words);
  /// A bit of `ending` says that the pixel's run ends less than so many pixels further to the right. (Where there is no
  /// run it says nothing.) Makes it twice as many, and returns how many runs are longer than these.
  std::size_t (*widen)(const PixelBits& ending, std::size_t pixels, const PixelBits& first, std::size_t words,
                       PixelBits& wider);
  /// Moves pixels that far to the right, and leaves out those whose runs end before. Returns how many arrive.
  std::size_t (*advance)(const PixelBits& from, const PixelBits& ending, std::size_t pixels, std::size_t words,
                         PixelBits& to);
  /// Which words are not zero.
  OccupiedWords (*find_words)(const PixelBits& bits, std::size_t words);
  /// The columns of the bits from left to right; words that are not occupied have none. Returns how many.
  std::size_t (*list)(const PixelBits& bits, OccupiedWords occupied, Columns& columns);
};

const RowBits& row_bits(KernelChoice kernel);

}  // namespace touchline
