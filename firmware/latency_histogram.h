#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.h"

namespace touchline {

/// Durations counted in bins that are a 64th of an octave wide, so that every percentile is at most 1.6 % too large, in
/// a fixed memory. Below 64 ns bins are 1 ns wide; above 137 s everything is in the last one. Negative counts as 0.
class LatencyHistogram {
 public:
  void add(Duration latency);
  void clear();

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// The duration that `fraction` (0 to 1) of all do not exceed: the upper edge of its bin, at most max(). 0 when
  /// empty.
  [[nodiscard]] Duration percentile(double fraction) const;
  /// Exact.
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
