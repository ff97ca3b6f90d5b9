#include "tools/programs/statistics/peaks_over_threshold.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>

namespace touchline::statistics {
namespace {

constexpr int kTrials = 999;
constexpr int kFits = 299;

// Returns the p-value: share of the random trials, the observed value included, that are at least as large.
class MonteCarlo {
 public:
  explicit MonteCarlo(double observed) : observed_(observed) {}
  void add(double trial) {
    ++trials_;
    larger_ += trial >= observed_ ? 1 : 0;
    smaller_ += trial <= observed_ ? 1 : 0;
  }
  [[nodiscard]] double above() const { return (1.0 + larger_) / (1.0 + trials_); }
  [[nodiscard]] double both_sides() const {
    return std::min(1.0, 2.0 * (1.0 + std::min(larger_, smaller_)) / (1.0 + trials_));
  }

 private:
  double observed_;
  int trials_ = 0, larger_ = 0, smaller_ = 0;
};

// Draws `count` of the numbers below `of` in ascending order (for a few hundred, Vitter's method A is not needed).
void draw_places(std::mt19937_64& random, std::size_t of, std::vector<std::size_t>& places) {
  const std::size_t count = places.size();
  std::uniform_int_distribution<std::size_t> any(0, of - 1);
  for (std::size_t found = 0; found < count;) {
    while (found < count) places[found++] = any(random);
    std::sort(places.begin(), places.end());
    found = static_cast<std::size_t>(std::unique(places.begin(), places.end()) - places.begin());
  }
}

// Returns the sum of the squared gaps (Greenwood 1946), which is large for clusters and small for regular gaps.
double squared_gaps(const std::vector<std::size_t>& places, std::size_t of) {
  double sum = 0.0, last = -1.0;
  for (const std::size_t place : places) {
    const double gap = static_cast<double>(place) - last;
    sum += gap * gap;
    last = static_cast<double>(place);
  }
  const double gap = static_cast<double>(of) - last;
  return sum + gap * gap;
}

double neighbors(const std::vector<std::size_t>& places) {
  double count = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) count += places[i] == places[i - 1] + 1 ? 1.0 : 0.0;
  return count;
}

// Returns the largest distance from a uniform distribution (Kolmogorov and Smirnov).
double unevenness(const std::vector<std::size_t>& places, std::size_t of) {
  double largest = 0.0;
  const auto count = static_cast<double>(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double share = (static_cast<double>(places[i]) + 0.5) / static_cast<double>(of);
    largest = std::max({largest, std::abs(share - static_cast<double>(i) / count),
                        std::abs(share - static_cast<double>(i + 1) / count)});
  }
  return largest;
}

std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) ranks[order[i]] = static_cast<double>(i);
  return ranks;
}

// These are, up to constants, the rank correlation of each value with the next one, and with time.
double with_next(const std::vector<double>& ranks) {
  double sum = 0.0;
  for (std::size_t i = 1; i < ranks.size(); ++i) sum += ranks[i] * ranks[i - 1];
  return sum;
}
double with_time(const std::vector<double>& ranks) {
  double sum = 0.0;
  for (std::size_t i = 0; i < ranks.size(); ++i) sum += static_cast<double>(i) * ranks[i];
  return sum;
}

}  // namespace

PeaksOverThreshold::PeaksOverThreshold(std::span<const double> values) : count_(values.size()) {
  if (count_ < kMinValues) return;
  const std::size_t peaks =
      std::clamp(static_cast<std::size_t>(kShare * static_cast<double>(count_)), kMinPeaks, kMaxPeaks);
  std::vector<double> sorted(values.begin(), values.end());
  const auto at = sorted.end() - static_cast<std::ptrdiff_t>(peaks) - 1;
  std::nth_element(sorted.begin(), at, sorted.end());
  threshold_ = *at;
  for (std::size_t i = 0; i < count_; ++i) {
    if (values[i] <= threshold_) continue;
    places_.push_back(i);
    excesses_.push_back(values[i] - threshold_);
  }
  // There are fewer peaks if many values equal the threshold.
  if (excesses_.size() >= kMinPeaks / 2) fit_.emplace(excesses_);
}

TailTests PeaksOverThreshold::test() const { return {independence(), stationarity(), fit_probability()}; }

double PeaksOverThreshold::independence() const {
  std::mt19937_64 random(1);
  std::vector<std::size_t> places = places_;
  std::vector<double> ranks = ranks_of(excesses_);
  MonteCarlo gaps(squared_gaps(places, count_)), clusters(neighbors(places)), sizes(with_next(ranks));
  for (int i = 0; i < kTrials; ++i) {
    draw_places(random, count_, places);
    gaps.add(squared_gaps(places, count_));
    clusters.add(neighbors(places));
    std::shuffle(ranks.begin(), ranks.end(), random);
    sizes.add(with_next(ranks));
  }
  // The level is divided by three, because there are three tests (Bonferroni).
  return std::min(1.0, 3.0 * std::min({gaps.both_sides(), clusters.above(), sizes.both_sides()}));
}

double PeaksOverThreshold::stationarity() const {
  std::mt19937_64 random(2);
  std::vector<std::size_t> places = places_;
  std::vector<double> ranks = ranks_of(excesses_);
  MonteCarlo frequency(unevenness(places, count_)), sizes(with_time(ranks));
  for (int i = 0; i < kTrials; ++i) {
    draw_places(random, count_, places);
    frequency.add(unevenness(places, count_));
    std::shuffle(ranks.begin(), ranks.end(), random);
    sizes.add(with_time(ranks));
  }
  return std::min(1.0, 2.0 * std::min(frequency.above(), sizes.both_sides()));
}

double PeaksOverThreshold::fit_probability() const {
  std::mt19937_64 random(3);
  // (1 - U is never 0.)
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  MonteCarlo distance(fit_->anderson_darling());
  std::vector<double> drawn(excesses_.size());
  for (int i = 0; i < kFits; ++i) {
    for (double& excess : drawn) excess = tail().quantile(1.0 - uniform(random));
    distance.add(ParetoFit(drawn).anderson_darling());
  }
  return distance.above();
}

std::string PeaksOverThreshold::refusal(const TailTests& tests) {
  std::string text;
  const auto check = [&text](double probability, const char* what) {
    if (probability >= kLevel) return;
    char number[48];
    std::snprintf(number, sizeof number, " (p %.3f)", probability);
    text += (text.empty() ? "" : "; ") + std::string(what) + number;
  };
  check(tests.independence, "the largest values are not independent");
  check(tests.stationarity, "the largest values change with time");
  check(tests.fit, "the largest values do not have the distribution of a tail");
  return text;
}

std::optional<Estimate> PeaksOverThreshold::level(double probability) const {
  const auto count = static_cast<double>(count_);
  const double share = static_cast<double>(peaks()) / count;
  constexpr double kCountable = 10.0;
  if (probability * count * kReach < 1.0 - 1e-9 || probability * count > kCountable) return std::nullopt;
  Estimate estimate = fit_->quantile(probability / share);
  estimate.value += threshold_;
  estimate.low += threshold_;
  if (estimate.high) *estimate.high += threshold_;
  return estimate;
}

std::optional<Estimate> PeaksOverThreshold::probability_above(double limit) const {
  if (limit <= threshold_) return std::nullopt;
  const double share = static_cast<double>(peaks()) / static_cast<double>(count_);
  Estimate estimate = fit_->survival(limit - threshold_);
  estimate.value *= share;
  estimate.low *= share;
  if (estimate.high) *estimate.high *= share;
  return estimate;
}

}  // namespace touchline::statistics
