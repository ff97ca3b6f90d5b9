#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "core/region/row_bits.h"
#include "core/region/row_masks.h"
#include "core/types.h"

namespace touchline {

/// Removes pixels without a 4-neighbor of their color, because each is a region of one pixel. `below`: masks of the
/// next row.
void remove_isolated_pixels(const RowMasks& below, RowMasks& masks);

/// Lists the runs of rows, without labels.
class RunWriter {
 public:
  /// `words`: number of words of a row.
  void configure(std::size_t words) { words_ = words; }

  [[nodiscard]] std::size_t count(const RowMasks& masks) const { return count_bits(masks.first, words_); }

  /// Removes the shortest runs of a row with more than `limit` runs. It tries the lengths 2, 3, 4, 6, 8, 12 ... 64,
  /// removes all runs up to the first length that suffices, or, if none does, keeps the leftmost of the longer runs.
  /// Returns how many are left. The masks then describe contacts of the remaining runs only.
  std::size_t cut(RowMasks& masks, std::size_t limit);

  /// Writes the runs of a row from left to right and returns their number. `out` must have room for them.
  std::size_t write(const RowMasks& masks, const ColorRow& colors, std::uint16_t row, Run* out);

  /// Finds the runs from which cutting removed a neighbor of their color in the row above or below. Call it for each
  /// row before find_contacts(), if one of the two rows is cut. Calls `lost_below(k)` for run k of the row above, and
  /// `lost_above(k)` for run k of this row.
  template <class LostBelow, class LostAbove>
  void find_cut_runs(const RowMasks& above, const RowMasks& masks, std::span<const Run> runs_above,
                     std::span<const Run> runs, LostBelow lost_below, LostAbove lost_above) const {
    const auto each = [this](std::span<const Run> of, auto lost, auto found) {
      std::size_t k = 0;
      for (std::size_t i = 0; i < words_; ++i) {
        for (std::uint64_t bits = lost(i); bits != 0; bits &= bits - 1) {
          const std::size_t u = i * kPixelsOfWord + static_cast<std::size_t>(std::countr_zero(bits));
          while (k < of.size() && of[k].end <= u) ++k;
          if (k == of.size()) return;
          if (of[k].begin <= u) found(k++);
        }
      }
    };
    if (masks.is_cut)
      each(
          runs_above, [&](std::size_t i) { return masks.removed_like_above[i]; }, lost_below);
    if (above.is_cut)
      each(
          runs, [&](std::size_t i) { return masks.like_above[i] & ~above.inside[i]; }, lost_above);
  }

  /// Returns the contacts between the runs of two rows; runs are numbered as write() wrote them.
  std::span<const Contact> find_contacts(const RowMasks& above, RowMasks& masks);

 private:
  std::size_t words_ = 0;
  // endings_[k] marks the pixels whose run ends less than 2^(k + 1) pixels to the right. halfway_ marks the pixels
  // whose run ends less than 3 * 2^k pixels to the right.
  std::array<PixelBits, 6> endings_;
  PixelBits halfway_;
  Columns columns_{}, last_columns_{};
  Contacts contacts_{};
};

}  // namespace touchline
