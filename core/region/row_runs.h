#pragma once

#include <array>
#include <cstdint>

#include "core/region/row_bits.h"
#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

/// Forgets pixels without a 4-neighbor of their color, regions of one pixel. `below` are the masks of the next row.
void forget_specks(const RowMasks& below, RowMasks& masks);

/// Lists the runs of rows, without labels.
class RunWriter {
 public:
  /// `words` of a row. `kernel`: the color kernel, which this processor has.
  void configure(KernelChoice kernel, std::size_t words);

  [[nodiscard]] std::size_t count(const RowMasks& masks) const { return bits_->count(masks.first, words_); }

  /// Writes all of a row's runs from left to right. Returns how many; `out` has room for them.
  std::size_t write_all(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out);

  /// Writes no more than `limit` runs, fewer than the row has: all that are longer than some length of less than
  /// kLongest, and where these are too many, of those of kLongest or more the leftmost. Returns how many; `out` has
  /// room for them.
  std::size_t write_longest(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, std::size_t limit,
                            Run* out);

  // Runs of at least this length are all equally long.
  static constexpr std::size_t kLongest = 64;

 private:
  void build(const ColorRow& colors, std::uint16_t row, std::size_t behind_first, std::size_t count, Run* out) const;

  const RowBits* bits_ = &row_bits(KernelChoice::kPortable);
  std::size_t words_ = 0;
  // Number k: pixels whose run ends less than 2^(k + 1) pixels further to the right.
  std::array<PixelBits, 5> endings_;
  // Of each run that is longer than some length the pixel that far behind its first one; and what is tried.
  std::array<PixelBits, 2> behind_;
  PixelBits ends_;
  Columns columns_{}, last_columns_{};
};

}  // namespace touchline
