#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/region/row_bits.h"
#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

/// Forgets pixels without a 4-neighbor of their color, regions of one pixel. `below` are the masks of the next row.
void remove_isolated_pixels(const RowMasks& below, RowMasks& masks);

/// Lists the runs of rows, without labels.
class RunWriter {
 public:
  /// `words` of a row. `kernel`: the color kernel, which this processor has.
  void configure(KernelChoice kernel, std::size_t words);

  [[nodiscard]] std::size_t count(const RowMasks& masks) const { return bits_->count(masks.first, words_); }

  /// Takes the shortest runs out of a row that has more than `limit`: up to a length of 2, 3, 4, 6, 8, 12 and so on to
  /// 64, the least of these that is enough; if none is, all but the leftmost of the longer ones. Returns how many are
  /// left. What the masks say of contacts with the row above is that of the runs that are left.
  std::size_t cut(RowMasks& masks, std::size_t limit);

  /// Writes a row's runs from left to right. Returns how many; `out` has room for them.
  std::size_t write(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out);

  /// The contacts of a row's runs with those of the row above, both as they were written.
  std::span<const Contact> find_contacts(const RowMasks& above, RowMasks& masks);

 private:
  const RowBits* bits_ = &row_bits(KernelChoice::kPortable);
  std::size_t words_ = 0;
  // Number k: pixels whose run ends less than 2^(k + 1) pixels further to the right; and less than 3 * 2^k.
  std::array<PixelBits, 6> endings_;
  PixelBits halfway_;
  Columns columns_{}, last_columns_{};
  Contacts contacts_{};
};

}  // namespace touchline
