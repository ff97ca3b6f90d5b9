#include "firmware/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace touchline {

std::size_t LatencyHistogram::bin_of(std::uint64_t ns) {
  constexpr std::uint64_t kLinear = std::uint64_t{1} << kBitsOfBin;
  if (ns < kLinear) return static_cast<std::size_t>(ns);
  const unsigned octave = static_cast<unsigned>(std::bit_width(ns)) - 1 - kBitsOfBin;
  const std::uint64_t within = (ns >> octave) - kLinear;
  return std::min<std::size_t>(((octave + 1) << kBitsOfBin) + static_cast<std::size_t>(within), kBins - 1);
}

std::uint64_t LatencyHistogram::upper_edge_ns(std::size_t bin) {
  const std::uint64_t within = bin & ((1U << kBitsOfBin) - 1);
  if (bin >> kBitsOfBin == 0) return within;
  const std::size_t octave = (bin >> kBitsOfBin) - 1;
  return ((((std::uint64_t{1} << kBitsOfBin) + within + 1) << octave)) - 1;
}

void LatencyHistogram::add(Duration latency) {
  const Duration positive = std::max(latency, Duration::zero());
  ++bins_[bin_of(static_cast<std::uint64_t>(positive.count()))];
  ++count_;
  max_ = std::max(max_, positive);
}

void LatencyHistogram::clear() {
  bins_.fill(0);
  count_ = 0;
  max_ = Duration::zero();
}

Duration LatencyHistogram::percentile(double fraction) const {
  const auto wanted =
      static_cast<std::uint64_t>(std::ceil(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin];
    if (seen >= wanted && seen > 0) {
      return std::min(Duration(static_cast<Duration::rep>(upper_edge_ns(bin))), max_);
    }
  }
  return max_;
}

}  // namespace touchline
