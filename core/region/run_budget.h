#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace touchline {

// What a realistic field needs, with room: 22 robots of 6 patches, each as high as 13 of 480 rows and every other row
// of it in two runs, are 2,600 runs, even if they all stand in one line; what else is seen has two more in each row.
// (On the fields of the leagues robots are smaller the more there are: 22 have a tenth of that.) A taller picture shows
// the same patches in more rows.
constexpr std::size_t kRunsPerRow = 2, kReservePerRow = 6, kLeastReserve = 3072;
static_assert((kReservePerRow + kRunsPerRow) * kMaxFrameHeight <= kMaxRuns, "a frame's budget must fit");

// No row of a realistic field has more: 44 patches in two runs each, and 40 more by specks on or beside them.
constexpr std::size_t kRealisticRow = 128;
// Nor do most rows have more than this, the patches of eight robots in one line.
constexpr std::size_t kUsualRow = 32;
// What a row with more is left with, as long as there is credit.
constexpr std::size_t kRunsOfCrowdedRow = kReservePerRow + kRunsPerRow;

/// How many runs the rows of a frame may have, so that no picture takes long. Every row adds kRunsPerRow to a credit,
/// from which it may take half. But a part of the credit is held back from rows with more than kUsualRow runs, and all
/// of it from those with more than kRealisticRow: they get kRunsOfCrowdedRow of it. So clutter leaves credit for the
/// rows after it, and the credit lasts for a whole frame of clutter. A frame is served whole if no row has more than
/// kRealisticRow runs and all rows down to any one have together no more than reserve(height) - held_back(height) and
/// kRunsPerRow each.
class RunBudget {
 public:
  static constexpr std::size_t reserve(std::size_t height_px) {
    return std::max(kReservePerRow * height_px, kLeastReserve);
  }
  static constexpr std::size_t held_back(std::size_t height_px) { return reserve(height_px) / 6; }

  void begin(std::size_t height_px) {
    credit_ = reserve(height_px);
    held_back_ = held_back(height_px);
  }
  /// How many of its runs the next row may keep.
  [[nodiscard]] std::size_t limit(std::size_t runs) const {
    const std::size_t credit = credit_ + kRunsPerRow, share = credit / 2;
    if (runs <= kUsualRow) return share;
    const std::size_t crowded = std::min(share, kRunsOfCrowdedRow);
    return runs > kRealisticRow ? crowded : std::max(crowded, credit - std::min(credit, held_back_));
  }
  /// The next row has that many, no more than the limit.
  void spend(std::size_t runs) { credit_ += kRunsPerRow - runs; }

 private:
  std::size_t credit_ = 0, held_back_ = 0;
};

}  // namespace touchline
