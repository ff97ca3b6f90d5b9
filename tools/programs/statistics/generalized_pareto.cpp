#include "tools/programs/statistics/generalized_pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tools/programs/statistics/statistics.h"

namespace touchline::statistics {
namespace {

// Shapes closer to zero are treated as the exponential distribution.
constexpr double kExponential = 1e-7;
constexpr double kImpossible = -std::numeric_limits<double>::infinity();
// Half of the 95 % quantile of chi-squared with one degree of freedom.
constexpr double kHalfChiSquared = 1.920729;
constexpr double kLargestMinusLog = 60.0;

// Returns the position of the largest value of `function` in [low, high], by a grid search and then golden sections
// around the best point.
template <class Function>
double place_of_maximum(double low, double high, int points, const Function& function) {
  const double step = (high - low) / (points - 1);
  double best = low, best_value = kImpossible;
  for (int i = 0; i < points; ++i) {
    const double x = low + i * step, value = function(x);
    if (value > best_value) best = x, best_value = value;
  }
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSections = 24;
  double a = std::max(low, best - step), b = std::min(high, best + step);
  double c = b - kGolden * (b - a), d = a + kGolden * (b - a);
  double at_c = function(c), at_d = function(d);
  for (int i = 0; i < kSections; ++i) {
    if (at_c > at_d) {
      b = d, d = c, at_d = at_c;
      c = b - kGolden * (b - a), at_c = function(c);
    } else {
      a = c, c = d, at_c = at_d;
      d = a + kGolden * (b - a), at_d = function(d);
    }
  }
  return std::max({std::pair(best_value, best), std::pair(at_c, c), std::pair(at_d, d)}).second;
}

// Returns the position at which `function` changes its sign between `inside` (positive or zero) and `outside`
// (negative).
template <class Function>
double place_of_change(double inside, double outside, const Function& function) {
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (function(middle) >= 0.0 ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

double GeneralizedPareto::survival(double excess) const {
  if (std::abs(shape) < kExponential) return std::exp(-excess / scale);
  const double base = 1.0 + shape * excess / scale;
  return base <= 0.0 ? 0.0 : std::pow(base, -1.0 / shape);
}

double GeneralizedPareto::quantile(double survival) const {
  if (std::abs(shape) < kExponential) return -scale * std::log(survival);
  return scale * std::expm1(-shape * std::log(survival)) / shape;
}

// With theta = shape / scale, the best shape is the mean of log(1 + theta * excess), so one number remains (Grimshaw
// 1993).
ParetoFit::ParetoFit(std::span<const double> excesses) : excesses_(excesses) {
  for (const double excess : excesses_) {
    mean_ += excess;
    largest_ = std::max(largest_, excess);
  }
  const auto count = static_cast<double>(excesses_.size());
  mean_ /= count;
  const auto distribution_at = [&](double log_end) {  // log(1 + theta * largest)
    const double theta = std::expm1(log_end) / largest_;
    if (std::abs(theta) * mean_ < kExponential) return GeneralizedPareto{mean_, 0.0};
    double shape = 0.0;
    for (const double excess : excesses_) shape += std::log1p(theta * excess);
    shape /= count;
    return GeneralizedPareto{shape / theta, shape};
  };
  const auto likelihood_at = [&](double log_end) {
    const GeneralizedPareto d = distribution_at(log_end);
    if (d.shape < kMinShape || d.shape > kMaxShape) return kImpossible;
    return -count * (std::log(d.scale) + d.shape + 1.0);
  };
  // Values are scaled by 1 / median, because the mean of a heavy tail depends on a single value.
  constexpr double kLowest = -12.0, kLargestTheta = 200.0;
  constexpr int kPoints = 41;
  std::vector<double> copy(excesses_.begin(), excesses_.end());
  const double highest = std::log1p(kLargestTheta * largest_ / median(copy));
  best_ = distribution_at(place_of_maximum(kLowest, highest, kPoints, likelihood_at));
  limit_ = log_likelihood(best_) - kHalfChiSquared;
}

double ParetoFit::log_likelihood(const GeneralizedPareto& d) const {
  const auto count = static_cast<double>(excesses_.size());
  if (!(d.scale > 0.0)) return kImpossible;
  if (std::abs(d.shape) < kExponential) return -count * (std::log(d.scale) + mean_ / d.scale);
  const double theta = d.shape / d.scale;
  if (1.0 + theta * largest_ <= 0.0) return kImpossible;
  double sum = 0.0;
  for (const double excess : excesses_) sum += std::log1p(theta * excess);
  return -count * std::log(d.scale) - (1.0 + 1.0 / d.shape) * sum;
}

double ParetoFit::profile(double excess, double minus_log) const {
  constexpr int kPoints = 33;
  const auto likelihood_at = [&](double shape) {
    const double scale =
        std::abs(shape) < kExponential ? excess / minus_log : shape * excess / std::expm1(shape * minus_log);
    return log_likelihood({scale, shape});
  };
  return likelihood_at(place_of_maximum(kMinShape, kMaxShape, kPoints, likelihood_at));
}

double ParetoFit::anderson_darling() const {
  std::vector<double> below(excesses_.begin(), excesses_.end());
  std::sort(below.begin(), below.end());
  for (double& value : below) value = std::clamp(1.0 - best_.survival(value), 1e-12, 1.0 - 1e-12);
  const std::size_t count = below.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += (2.0 * static_cast<double>(i) + 1.0) * (std::log(below[i]) + std::log1p(-below[count - 1 - i]));
  }
  return -static_cast<double>(count) - sum / static_cast<double>(count);
}

Estimate ParetoFit::quantile(double survival) const {
  const double minus_log = -std::log(survival);
  Estimate estimate{best_.quantile(survival), 0.0, std::nullopt};
  const auto margin = [&](double excess) { return profile(excess, minus_log) - limit_; };
  constexpr double kSmallest = 1e-3;
  estimate.low = place_of_change(estimate.value, kSmallest * estimate.value, margin);
  constexpr int kDoublings = 20;
  double outside = 2.0 * estimate.value;
  for (int i = 0; i < kDoublings; ++i, outside *= 2.0) {
    if (margin(outside) >= 0.0) continue;
    estimate.high = place_of_change(outside > 2.0 * estimate.value ? outside / 2.0 : estimate.value, outside, margin);
    break;
  }
  return estimate;
}

Estimate ParetoFit::survival(double excess) const {
  const double best = best_.survival(excess);
  const double minus_log = best > 0.0 ? std::min(-std::log(best), kLargestMinusLog) : kLargestMinusLog;
  const auto margin = [&](double candidate) { return profile(excess, candidate) - limit_; };
  Estimate estimate{best, 0.0, std::nullopt};
  if (margin(kLargestMinusLog) < 0.0) {
    estimate.low = std::exp(-place_of_change(minus_log, kLargestMinusLog, margin));
  }
  constexpr double kAlmostCertain = 1e-3;
  // If the best distribution excludes such an excess, a point inside the interval must be found first.
  double inside = minus_log;
  while (margin(inside) < 0.0 && inside > 1.0) inside *= 0.9;
  estimate.high = std::exp(-place_of_change(inside, kAlmostCertain, margin));
  return estimate;
}

}  // namespace touchline::statistics
