#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

// Order statistics and error summaries for tools, tests and benchmarks.
namespace touchline::statistics {

/// Nearest-rank percentile: the smallest value that at least `percent` % of all values do not exceed. `sorted` must be
/// ascending and not empty; `percent` in (0, 100].
template <class T>
T percentile(std::span<const T> sorted, double percent) {
  // The correction is needed because 99.9 % of 1000 must give rank 999, but rounding errors of 0.999 * 1000 would give
  // 1000.
  const double rank = percent / 100.0 * static_cast<double>(sorted.size()) - 1e-9;
  auto index = static_cast<std::size_t>(rank);
  if (static_cast<double>(index) < rank) ++index;  // this rounds up
  return sorted[(index == 0 ? 1 : index) - 1];
}

/// Upper median: of an even number of values, the larger of the two middle ones. Reorders `values`, which must not be
/// empty.
template <class Values>
auto median(Values& values) {
  const auto middle = std::begin(values) + static_cast<std::ptrdiff_t>(std::size(values) / 2);
  std::nth_element(std::begin(values), middle, std::end(values));
  return *middle;
}

/// Lower median: of an even number of values, the smaller of the two middle ones. Reorders `values`, which must not be
/// empty.
template <class Values>
auto lower_median(Values& values) {
  const auto middle = std::begin(values) + static_cast<std::ptrdiff_t>((std::size(values) - 1) / 2);
  std::nth_element(std::begin(values), middle, std::end(values));
  return *middle;
}

/// Returns the arithmetic mean; 0 without values.
double mean(std::span<const double> values);

/// Returns the root mean square; 0 without values.
double rms(std::span<const double> values);

/// Magnitudes of errors; all zero without errors.
struct ErrorSummary {
  std::size_t count = 0;
  double rms = 0.0, p95 = 0.0, max = 0.0;
};
/// The signs of the errors are ignored. `p95` is the nearest-rank percentile.
ErrorSummary summarize(std::vector<double> errors);

}  // namespace touchline::statistics
