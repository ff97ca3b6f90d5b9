#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace touchline::statistics {

struct Interval {
  std::int64_t low = 0, high = 0;
};

/// Confidence intervals of percentiles of a series in which neighboring values are correlated, such as the times of
/// consecutive frames. The series is cut into kBlocks blocks whose lengths differ by at most one, and blocks are drawn
/// with replacement (block bootstrap; Kunsch 1989). Intervals for independent values would be too narrow. The interval
/// does not cover changes that are slower than a block, or that differ from run to run.
class BlockBootstrap {
 public:
  static constexpr std::size_t kBlocks = 40, kResamples = 1000;

  /// `values` must be in the order of time.
  explicit BlockBootstrap(std::span<const std::int64_t> values);

  /// Returns the 95 % confidence interval of the nearest-rank percentile; `percent` in (0, 100). Empty with fewer than
  /// five values per block, or if fewer than five values are above the percentile. The same values give the same
  /// interval.
  [[nodiscard]] std::optional<Interval> interval(double percent) const;

 private:
  using BlockCounts = std::array<std::uint32_t, kBlocks>;
  [[nodiscard]] std::int64_t percentile(const BlockCounts& times_drawn, double percent) const;

  struct Value {
    std::int64_t value = 0;
    std::uint8_t block = 0;
  };
  std::size_t least_block_length_;
  BlockCounts block_lengths_{};
  std::vector<Value> sorted_;
  std::vector<BlockCounts> before_;  // for every kStride-th value, the number of smaller values in each block
};

}  // namespace touchline::statistics
