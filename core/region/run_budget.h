#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace touchline {

// What a realistic field needs, with room: 22 robots of 6 patches, each as high as 13 of 480 rows and in two runs a
// row, are 3,400 runs. A taller picture shows the same patches in more rows.
constexpr std::size_t kRunsPerRow = 8, kReservePerRow = 8, kLeastReserve = 4096;
static_assert((kReservePerRow + kRunsPerRow) * kMaxFrameHeight <= kMaxRuns, "a frame's budget must fit");

/// How many runs the rows of a frame may have, so that no picture takes long. Every row adds kRunsPerRow to a credit,
/// from which a row may take an eighth: crowded rows get less and less, but never all, so that rows after them have
/// some. A frame is served whole if no row has more than 128 runs and all rows down to any one have together no more
/// than reserve(height) - 1,024 and kRunsPerRow each.
class RunBudget {
 public:
  static constexpr std::size_t reserve(std::size_t height_px) {
    return std::max(kReservePerRow * height_px, kLeastReserve);
  }

  void begin(std::size_t height_px) { credit_ = reserve(height_px); }
  /// The most that the next row may have.
  [[nodiscard]] std::size_t limit() const { return (credit_ + kRunsPerRow) / kRowsOfCredit; }
  /// The next row has that many, no more than the limit.
  void spend(std::size_t runs) { credit_ += kRunsPerRow - runs; }

 private:
  static constexpr std::size_t kRowsOfCredit = 8;
  std::size_t credit_ = 0;
};

}  // namespace touchline
