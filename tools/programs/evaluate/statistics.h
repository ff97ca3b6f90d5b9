#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace touchline::evaluate {

/// Nearest-rank percentile of ascending values: the smallest one that at least `percent` of all do not exceed.
/// `sorted` must not be empty; percent in (0, 100].
template <class T>
T percentile(std::span<const T> sorted, double percent) {
  // 99.9 % of 1000 is 999, not the next rank because 0.999 is no binary number.
  const double rank = percent / 100.0 * static_cast<double>(sorted.size()) - 1e-9;
  auto index = static_cast<std::size_t>(rank);
  if (static_cast<double>(index) < rank) ++index;  // rounded up
  return sorted[(index == 0 ? 1 : index) - 1];
}

/// Magnitudes of errors; all zero when there is none.
struct ErrorSummary {
  std::size_t count = 0;
  double rms = 0.0, p95 = 0.0, max = 0.0;
};
ErrorSummary summarize(std::vector<double> errors);

/// To (-pi, pi].
double wrapped(double angle_rad);

}  // namespace touchline::evaluate
