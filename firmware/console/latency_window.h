#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.h"

namespace touchline::console {

/// Counts of latencies in bins of 1/16 octave from 1/16 ms to 4 s. Bins are coarse, because the counts are sent every
/// second.
class LatencyBins {
 public:
  static constexpr std::size_t kBinsOfOctave = 16, kBins = 16 * kBinsOfOctave;

  void add(Duration latency);
  void add(const LatencyBins& other);
  void clear() { *this = {}; }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::uint32_t of(std::size_t bin) const { return bins_[bin]; }
  [[nodiscard]] Duration max() const { return max_; }
  /// Returns the quantile at `fraction` (0 to 1): the upper edge of its bin, at most max().
  [[nodiscard]] Duration percentile(double fraction) const;
  static double upper_edge_ms(std::size_t bin);

 private:
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  Duration max_{};
};

/// Counts latencies since the start, and the latencies of the last minute in steps of a second.
class LatencyWindow {
 public:
  static constexpr std::size_t kSeconds = 60;

  void add(Duration latency) {
    total_.add(latency);
    seconds_[second_ % kSeconds].add(latency);
  }
  /// Call it when a second has passed.
  void next_second() { seconds_[++second_ % kSeconds].clear(); }
  [[nodiscard]] const LatencyBins& total() const { return total_; }
  [[nodiscard]] LatencyBins last_minute() const;

 private:
  LatencyBins total_;
  std::array<LatencyBins, kSeconds> seconds_{};
  std::size_t second_ = 0;
};

}  // namespace touchline::console
