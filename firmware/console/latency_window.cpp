#include "firmware/console/latency_window.h"

#include <algorithm>
#include <cmath>

namespace touchline::console {
namespace {

constexpr double kFirstEdgeMs = 1.0 / 16.0;

}  // namespace

double LatencyBins::upper_edge_ms(std::size_t bin) {
  return kFirstEdgeMs * std::exp2(static_cast<double>(bin + 1) / static_cast<double>(kBinsOfOctave));
}

void LatencyBins::add(Duration latency) {
  const double ms = std::max(seconds(latency) * 1e3, kFirstEdgeMs);
  const double bin = std::floor(std::log2(ms / kFirstEdgeMs) * static_cast<double>(kBinsOfOctave));
  ++bins_[std::min(static_cast<std::size_t>(bin), kBins - 1)];
  ++count_;
  max_ = std::max(max_, latency);
}

void LatencyBins::add(const LatencyBins& other) {
  for (std::size_t i = 0; i < kBins; ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
  max_ = std::max(max_, other.max_);
}

Duration LatencyBins::percentile(double fraction) const {
  const double wanted = std::ceil(fraction * static_cast<double>(count_));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin];
    if (seen > 0 && static_cast<double>(seen) >= wanted) return std::min(from_seconds(upper_edge_ms(bin) / 1e3), max_);
  }
  return max_;
}

LatencyBins LatencyWindow::last_minute() const {
  LatencyBins sum;
  for (const LatencyBins& second : seconds_) sum.add(second);
  return sum;
}

}  // namespace touchline::console
