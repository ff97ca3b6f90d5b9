#include "tools/programs/statistics/statistics.h"

#include <cmath>
#include <numeric>

namespace touchline::statistics {

double mean(std::span<const double> values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

ErrorSummary summarize(std::vector<double> errors) {
  ErrorSummary summary;
  if (errors.empty()) return summary;
  summary.count = errors.size();
  summary.rms = rms(errors);
  for (double& error : errors) error = std::abs(error);
  std::sort(errors.begin(), errors.end());
  summary.p95 = percentile(std::span<const double>(errors), 95.0);
  summary.max = errors.back();
  return summary;
}

}  // namespace touchline::statistics
