#pragma once

#include <optional>
#include <span>

namespace touchline::statistics {

/// Distribution of the amounts by which values exceed a high threshold (Pickands 1975, Balkema and de Haan 1974).
struct GeneralizedPareto {
  double scale = 1.0;
  double shape = 0.0;  // below 0: there is a largest value; 0: exponential; above 0: heavy tail

  /// Returns the probability that an excess is larger than `excess` (>= 0).
  [[nodiscard]] double survival(double excess) const;
  /// Upper quantile: returns the excess that is exceeded with probability `survival` (0 to 1).
  [[nodiscard]] double quantile(double survival) const;
};

/// An estimate and its 95 % confidence interval; `high` is empty if the data give no upper limit.
struct Estimate {
  double value = 0.0, low = 0.0;
  std::optional<double> high;
};

/// Maximum-likelihood fit, with a shape from -0.5 (below, the method is not regular) to kMaxShape.
class ParetoFit {
 public:
  static constexpr double kMinShape = -0.5, kMaxShape = 5.0;

  /// `excesses`: at least 10 positive values, which must outlive this object.
  explicit ParetoFit(std::span<const double> excesses);
  [[nodiscard]] const GeneralizedPareto& distribution() const { return best_; }
  /// Returns the distance between data and fit with more weight on the tail (Anderson and Darling 1952); larger is
  /// worse.
  [[nodiscard]] double anderson_darling() const;
  /// Returns the excess that is exceeded with probability `survival`, with its profile-likelihood interval (Coles 2001,
  /// 4.3.3).
  [[nodiscard]] Estimate quantile(double survival) const;
  /// Returns the probability that an excess is larger than `excess` > 0, with its profile-likelihood interval.
  [[nodiscard]] Estimate survival(double excess) const;

 private:
  [[nodiscard]] double log_likelihood(const GeneralizedPareto& distribution) const;
  // Returns the largest likelihood of all distributions in which `excess` is exceeded with the probability
  // exp(-`minus_log`).
  [[nodiscard]] double profile(double excess, double minus_log) const;

  std::span<const double> excesses_;
  double mean_ = 0.0, largest_ = 0.0, limit_ = 0.0;  // limit_: log-likelihood at the ends of a 95 % interval
  GeneralizedPareto best_;
};

}  // namespace touchline::statistics
