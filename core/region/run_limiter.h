#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace touchline {

// Credit that a realistic field needs, with a margin. 22 robots with 6 patches, each 13 of 480 rows high and split in
// two runs in every other row, have 2,600 runs, even if all stand in one line. Other objects add two runs to each row.
// (In the leagues, robots in large teams are smaller: 22 of them have a tenth of these runs.) A taller picture shows
// the patches in more rows.
constexpr std::size_t kRunsPerRow = 2, kReservePerRow = 6, kMinReserve = 3072;
static_assert((kReservePerRow + kRunsPerRow) * kMaxFrameHeight <= kMaxRuns, "a frame's budget must fit");

// Largest number of runs in a row of a realistic field: 44 patches with two runs each, and 40 isolated pixels on or
// beside them.
constexpr std::size_t kRealisticRow = 128;
// Largest number of runs in most rows: the patches of eight robots in one line.
constexpr std::size_t kUsualRow = 32;
// Number of runs that a row with more than kRealisticRow runs keeps, as long as there is credit.
constexpr std::size_t kRunsOfCrowdedRow = kReservePerRow + kRunsPerRow;

/// Limits the number of runs in each row with a token bucket, which bounds the time for any picture. Every row adds
/// kRunsPerRow to a credit and may take half of it. Rows with more than kUsualRow runs cannot use the part of the
/// credit that is held back. Rows with more than kRealisticRow runs get only kRunsOfCrowdedRow. Clutter therefore
/// leaves credit for later rows, and the credit lasts for a whole frame of clutter.
///
/// A frame keeps all its runs if no row has more than kRealisticRow runs and if, for each row, all rows from the top to
/// this one have at most reserve(height) - held_back(height) runs plus kRunsPerRow per row.
class RunLimiter {
 public:
  static constexpr std::size_t reserve(std::size_t height_px) {
    return std::max(kReservePerRow * height_px, kMinReserve);
  }
  static constexpr std::size_t held_back(std::size_t height_px) { return reserve(height_px) / 6; }

  void begin(std::size_t height_px) {
    credit_ = reserve(height_px);
    held_back_ = held_back(height_px);
  }
  /// Returns how many of its `runs` the next row may keep.
  [[nodiscard]] std::size_t limit(std::size_t runs) const {
    const std::size_t credit = credit_ + kRunsPerRow, share = credit / 2;
    if (runs <= kUsualRow) return share;
    const std::size_t crowded = std::min(share, kRunsOfCrowdedRow);
    return runs > kRealisticRow ? crowded : std::max(crowded, credit - std::min(credit, held_back_));
  }
  /// Subtracts the runs of the next row, at most its limit.
  void spend(std::size_t runs) { credit_ += kRunsPerRow - runs; }

 private:
  std::size_t credit_ = 0, held_back_ = 0;
};

}  // namespace touchline
