#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.h"

namespace touchline {

/// Histogram of durations in fixed memory. Bins are 1/64 octave wide, so percentiles are at most 1.6 % too large. Below
/// 64 ns bins are 1 ns wide; durations above 137 s are in the last bin. Negative durations count as 0.
class LatencyHistogram {
 public:
  void add(Duration latency);
  void clear();

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Returns the quantile at `fraction` (0 to 1): the upper edge of its bin, at most max(). 0 if the histogram is
  /// empty.
  [[nodiscard]] Duration percentile(double fraction) const;
  /// Returns the longest duration; this value is exact.
  [[nodiscard]] Duration max() const { return max_; }

 private:
  static constexpr unsigned kBitsOfBin = 6;
  static constexpr std::size_t kOctaves = 32;
  static constexpr std::size_t kBins = kOctaves << kBitsOfBin;
  static std::size_t bin_of(std::uint64_t ns);
  static std::uint64_t upper_edge_ns(std::size_t bin);

  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  Duration max_{};
};

}  // namespace touchline
