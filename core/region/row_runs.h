#pragma once

#include <array>
#include <cstdint>

#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

/// Forgets pixels without a 4-neighbor of their color, regions of one pixel. `below` are the masks of the next row.
void forget_specks(const RowMasks& below, RowMasks& masks);

[[nodiscard]] std::size_t count_runs(const RowMasks& masks, std::size_t words);

/// Writes the row's runs from left to right, without labels. Returns how many; `out` has room for them.
std::size_t write_runs(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out);

/// The longest runs of a row.
class RunChoice {
 public:
  /// Writes no more than `limit` runs, fewer than the row has: all that are longer than some length, and where that is
  /// kLongest or more, of those the leftmost. The masks lose short runs. Returns how many; `out` has room for one more.
  std::size_t write_longest(RowMasks& masks, const ColorRow& colors, std::size_t words, std::uint16_t row,
                            std::size_t limit, Run* out);

  // Runs of at least this length are all equally long.
  static constexpr std::size_t kLongest = 64;

 private:
  // Shorter runs are forgotten many pixels at a time, the others one by one.
  static constexpr std::size_t kListed = 8;
  static std::size_t count_longer(const RowMasks& masks, std::size_t words, std::size_t length);
  static void forget_up_to(std::size_t length, std::size_t words, RowMasks& masks);

  std::size_t short_ones_ = 1;  // what was short in the last such row, most often about the same in the next
  std::array<Run, kMaxRowWords * kPixelsOfWord / kListed> listed_{};
};

}  // namespace touchline
