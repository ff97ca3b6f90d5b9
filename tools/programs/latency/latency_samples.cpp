#include "tools/programs/latency/latency_samples.h"

#include <algorithm>

#include "tools/programs/statistics/block_bootstrap.h"
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
  std::vector<std::int64_t> in_order;
  in_order.reserve(count_);
  for (std::size_t i = 0; i < count_; ++i) in_order.push_back(samples_[i].count());
  const statistics::BlockBootstrap bootstrap(in_order);
  const auto interval = [&bootstrap](double percent) -> std::optional<TimeInterval> {
    const std::optional<statistics::Interval> found = bootstrap.interval(percent);
    if (!found) return std::nullopt;
    return TimeInterval{Duration(found->low), Duration(found->high)};
  };
  summary.p50_interval = interval(50.0);
  summary.p99_interval = interval(99.0);
  summary.p99_9_interval = interval(99.9);
  return summary;
}

std::uint64_t LatencySamples::longer_than(Duration limit) const {
  const auto end = samples_.begin() + static_cast<std::ptrdiff_t>(count_);
  return static_cast<std::uint64_t>(std::count_if(samples_.begin(), end, [limit](Duration d) { return d > limit; }));
}

}  // namespace touchline::latency
