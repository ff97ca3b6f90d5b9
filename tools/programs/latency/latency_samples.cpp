#include "tools/programs/latency/latency_samples.h"

#include <algorithm>

#include "tools/programs/statistics/statistics.h"

namespace touchline::latency {

LatencySummary LatencySamples::summarize() const {
  LatencySummary summary;
  if (count_ == 0) return summary;
  std::vector<Duration> sorted(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(count_));
  std::sort(sorted.begin(), sorted.end());
  const std::span<const Duration> all(sorted);
  summary.p50 = statistics::percentile(all, 50.0);
  summary.p90 = statistics::percentile(all, 90.0);
  summary.p99 = statistics::percentile(all, 99.0);
  summary.p99_9 = statistics::percentile(all, 99.9);
  summary.max = sorted.back();
  return summary;
}

std::uint64_t LatencySamples::longer_than(Duration limit) const {
  const auto end = samples_.begin() + static_cast<std::ptrdiff_t>(count_);
  return static_cast<std::uint64_t>(std::count_if(samples_.begin(), end, [limit](Duration d) { return d > limit; }));
}

}  // namespace touchline::latency
