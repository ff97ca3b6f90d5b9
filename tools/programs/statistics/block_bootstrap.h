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

/// Confidence intervals of percentiles of a series whose neighboring values depend on each other, such as the times of
/// consecutive frames: the series is cut into kBlocks blocks whose lengths differ by at most one, and blocks are drawn
/// with replacement (block bootstrap; Kunsch 1989). Intervals of independent values would be too narrow. Changes that
/// are slower than a block, or that differ from run to run, are not in the interval.
class BlockBootstrap {
 public:
  static constexpr std::size_t kBlocks = 40, kResamples = 1000;

  /// `values` in the order of time.
  explicit BlockBootstrap(std::span<const std::int64_t> values);

  /// 95 % interval of the nearest-rank percentile; `percent` in (0, 100). Empty with fewer than five values per block,
  /// or if fewer than five values are above the percentile. The same values give the same interval.
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
  std::vector<BlockCounts> before_;  // at every kStride-th value: how many smaller ones each block has
};

}  // namespace touchline::statistics
