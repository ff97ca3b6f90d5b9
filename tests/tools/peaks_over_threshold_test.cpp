// Estimates of rare values, against distributions whose tails are known.
#include "tools/programs/statistics/peaks_over_threshold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace touchline::statistics {
namespace {

using Random = std::mt19937_64;

std::vector<double> series(unsigned seed, std::size_t count, const std::function<double(Random&, std::size_t)>& next) {
  Random random(seed);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = next(random, i);
  return values;
}

std::vector<double> pareto(unsigned seed, std::size_t count, const GeneralizedPareto& distribution) {
  return series(seed, count, [&](Random& random, std::size_t) {
    return distribution.quantile(1.0 - std::uniform_real_distribution<double>(0.0, 1.0)(random));
  });
}

TEST(GeneralizedPareto, SurvivalIsTheInverseOfTheQuantile) {
  for (const double shape : {-0.4, -1e-9, 0.0, 0.3, 1.2}) {
    const GeneralizedPareto d{2.5, shape};
    for (const double p : {0.9, 0.5, 1e-3, 1e-6}) EXPECT_NEAR(d.survival(d.quantile(p)) / p, 1.0, 1e-9) << shape;
  }
  EXPECT_EQ((GeneralizedPareto{1.0, -0.5}).survival(2.1), 0.0) << "beyond the largest value";
}

TEST(ParetoFit, FindsScaleAndShape) {
  for (const GeneralizedPareto truth : {GeneralizedPareto{1.0, 0.0}, {0.02, 0.25}, {300.0, -0.3}, {5.0, 0.9}}) {
    const std::vector<double> values = pareto(1, 20000, truth);
    const GeneralizedPareto found = ParetoFit(values).distribution();
    EXPECT_NEAR(found.scale / truth.scale, 1.0, 0.05);
    EXPECT_NEAR(found.shape, truth.shape, 0.04);
  }
}

// 95 % of the intervals should contain the truth; 60 intervals contain it less often than 52 times in 1 of 100 cases.
TEST(PeaksOverThreshold, IntervalsContainTheTruth) {
  for (const GeneralizedPareto truth : {GeneralizedPareto{1.0, 0.0}, {1.0, 0.2}, {1.0, -0.2}}) {
    int levels = 0, probabilities = 0;
    constexpr int kRuns = 60;
    constexpr double kRare = 1e-5;
    const double limit = truth.quantile(kRare);
    double sum = 0.0;
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      const std::vector<double> values = pareto(seed, 6000, truth);
      const PeaksOverThreshold tail(values);
      ASSERT_TRUE(tail.is_enough());
      const std::optional<Estimate> level = tail.level(kRare), above = tail.probability_above(limit);
      ASSERT_TRUE(level && above);
      EXPECT_LE(level->low, level->value);
      EXPECT_LE(level->value, level->high.value_or(1e9));
      sum += std::log(level->value / limit);
      levels += level->low <= limit && limit <= level->high.value_or(1e9) ? 1 : 0;
      probabilities += above->low <= kRare && kRare <= above->high.value_or(1.0) ? 1 : 0;
    }
    EXPECT_GE(levels, 52) << truth.shape;
    EXPECT_GE(probabilities, 52) << truth.shape;
    EXPECT_NEAR(sum / kRuns, 0.0, 0.12) << truth.shape;
  }
}

TEST(PeaksOverThreshold, KnowsTheTailOfANormalDistribution) {
  const std::vector<double> values =
      series(4, 20000, [](Random& random, std::size_t) { return std::normal_distribution<double>(10.0, 1.0)(random); });
  const PeaksOverThreshold tail(values);
  const std::optional<Estimate> level = tail.level(1e-6);
  ASSERT_TRUE(level);
  EXPECT_LE(level->low, 14.753);
  EXPECT_GE(level->high.value_or(1e9), 14.753);
  EXPECT_NEAR(level->value, 14.753, 0.8);
}

// Each test fails by chance in 1 % of good data.
TEST(PeaksOverThreshold, GoodDataAreSeldomRefused) {
  int refused = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const std::vector<double> values = series(
        seed, 4000, [](Random& random, std::size_t) { return std::lognormal_distribution<double>(0.0, 0.4)(random); });
    refused += PeaksOverThreshold::refusal(PeaksOverThreshold(values).test()).empty() ? 0 : 1;
  }
  EXPECT_LE(refused, 2);
}

std::string refusal_of(const std::function<double(Random&, std::size_t)>& next, std::size_t count = 8000) {
  const std::vector<double> values = series(7, count, next);
  const PeaksOverThreshold tail(values);
  EXPECT_TRUE(tail.is_enough());
  return PeaksOverThreshold::refusal(tail.test());
}

TEST(PeaksOverThreshold, DependentDataAreRefused) {
  double state = 0.0;
  const std::string correlated = refusal_of(
      [&](Random& random, std::size_t) { return state = 0.7 * state + std::normal_distribution<double>()(random); });
  EXPECT_NE(correlated.find("not independent (p 0.0"), std::string::npos) << correlated;
  // A timer disturbs every 25th frame.
  const std::string periodic = refusal_of([](Random& random, std::size_t i) {
    return (i % 25 == 0 ? 3.0 : 0.0) + std::exponential_distribution<double>(2.0)(random);
  });
  EXPECT_NE(periodic.find("not independent"), std::string::npos) << periodic;
  // Bursts: of 1000 values, 60 in a row are slow.
  const std::string bursts = refusal_of([](Random& random, std::size_t i) {
    return (i % 1000 < 60 ? 2.0 : 0.0) + std::exponential_distribution<double>(1.0)(random);
  });
  EXPECT_NE(bursts.find("not independent"), std::string::npos) << bursts;
}

TEST(PeaksOverThreshold, DataThatChangeWithTimeAreRefused) {
  const std::string rising = refusal_of([](Random& random, std::size_t i) {
    return static_cast<double>(i) / 8000.0 + std::exponential_distribution<double>(1.0)(random);
  });
  EXPECT_NE(rising.find("change with time"), std::string::npos) << rising;
  // Both halves have the same number of peaks, but the peaks of the second half are larger.
  const std::string larger = refusal_of([](Random& random, std::size_t i) {
    const double excess = std::exponential_distribution<double>(1.0)(random);
    return excess > 2.0 && i > 4000 ? 2.0 + 3.0 * (excess - 2.0) : excess;
  });
  EXPECT_NE(larger.find("change with time"), std::string::npos) << larger;
}

TEST(PeaksOverThreshold, DataWithTwoModesAreRefused) {
  // One of 100 frames waits 12 ms for a processor.
  const std::string bimodal = refusal_of([](Random& random, std::size_t) {
    const bool waits = std::uniform_real_distribution<double>()(random) < 0.01;
    return (waits ? 12.0 : 0.0) + std::normal_distribution<double>(1.0, 0.1)(random);
  });
  EXPECT_NE(bimodal.find("do not have the distribution of a tail"), std::string::npos) << bimodal;
}

TEST(PeaksOverThreshold, SaysNothingWithoutEnoughData) {
  EXPECT_FALSE(PeaksOverThreshold(pareto(1, PeaksOverThreshold::kMinValues - 1, {})).is_enough());
  EXPECT_FALSE(PeaksOverThreshold(std::vector<double>(5000, 3.0)).is_enough()) << "all values are equal";
  const std::vector<double> values = pareto(1, 5000, {});
  const PeaksOverThreshold tail(values);
  EXPECT_FALSE(tail.level(1e-2).has_value()) << "observed often enough";
  EXPECT_FALSE(tail.level(1e-6).has_value()) << "beyond 100 times the number of values";
  EXPECT_TRUE(tail.level(2e-6).has_value());
  EXPECT_FALSE(tail.probability_above(tail.threshold()).has_value());
}

}  // namespace
}  // namespace touchline::statistics
