#include "tools/programs/evaluate/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::evaluate {

ErrorSummary summarize(std::vector<double> errors) {
  ErrorSummary summary;
  if (errors.empty()) return summary;
  double squares = 0.0;
  for (double& error : errors) {
    error = std::abs(error);
    squares += error * error;
  }
  std::sort(errors.begin(), errors.end());
  summary.count = errors.size();
  summary.rms = std::sqrt(squares / static_cast<double>(errors.size()));
  summary.p95 = percentile(std::span<const double>(errors), 95.0);
  summary.max = errors.back();
  return summary;
}

double wrapped(double angle_rad) {
  constexpr double kPi = std::numbers::pi;
  const double angle = std::remainder(angle_rad, 2.0 * kPi);
  return angle <= -kPi ? angle + 2.0 * kPi : angle;
}

}  // namespace touchline::evaluate
