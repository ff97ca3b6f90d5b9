#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/programs/statistics/generalized_pareto.h"

namespace touchline::statistics {

/// p-values: probabilities that data which fulfill a requirement deviate from it at least as much as these data.
struct TailTests {
  double independence = 0.0;  // the largest values are neither clustered nor spread evenly, nor alike if neighbors
  double stationarity = 0.0;  // the largest values become neither more frequent nor larger with time
  double fit = 0.0;           // their excesses have a generalized Pareto distribution
};

/// Estimates how often values occur that are too rare to have been observed, from the largest observed values (peaks
/// over threshold; Davison and Smith 1990). The estimate is valid only if refusal() is empty.
class PeaksOverThreshold {
 public:
  static constexpr std::size_t kMinValues = 2000, kMinPeaks = 100, kMaxPeaks = 500;
  static constexpr double kShare = 0.05;   // share of the values that are peaks, within these limits
  static constexpr double kLevel = 0.01;   // a test fails if its p-value is below this
  static constexpr double kReach = 100.0;  // longest extrapolation, in multiples of the number of values

  /// `values` must be in the order of time.
  explicit PeaksOverThreshold(std::span<const double> values);
  ~PeaksOverThreshold() = default;
  PeaksOverThreshold(const PeaksOverThreshold&) = delete;
  PeaksOverThreshold& operator=(const PeaksOverThreshold&) = delete;

  [[nodiscard]] bool is_enough() const { return fit_.has_value(); }
  /// Runs the tests by Monte Carlo with a fixed seed, which takes about a second. Requires is_enough().
  [[nodiscard]] TailTests test() const;
  /// Returns the requirements that are not met: "the largest values are not independent (p 0.000)"; "" if all are.
  [[nodiscard]] static std::string refusal(const TailTests& tests);

  [[nodiscard]] double threshold() const { return threshold_; }
  [[nodiscard]] std::size_t peaks() const { return excesses_.size(); }
  [[nodiscard]] const GeneralizedPareto& tail() const { return fit_->distribution(); }
  /// Returns the value that is exceeded with this probability, with its 95 % confidence interval. Empty if the
  /// probability is beyond kReach, or so large that values exceeded it often enough to count them.
  [[nodiscard]] std::optional<Estimate> level(double probability) const;
  /// Returns the probability of a value above `limit`. Empty if `limit` is not above the threshold.
  [[nodiscard]] std::optional<Estimate> probability_above(double limit) const;

 private:
  [[nodiscard]] double independence() const;
  [[nodiscard]] double stationarity() const;
  [[nodiscard]] double fit_probability() const;

  std::size_t count_;
  double threshold_ = 0.0;
  std::vector<std::size_t> places_;  // excesses of the peaks, ascending
  std::vector<double> excesses_;     // in the order of excesses
  std::optional<ParetoFit> fit_;
};

}  // namespace touchline::statistics
