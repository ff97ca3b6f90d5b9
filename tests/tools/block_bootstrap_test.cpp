#include "tools/programs/statistics/block_bootstrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tools/programs/statistics/statistics.h"

namespace touchline::statistics {
namespace {

// A stationary series of normal values (mean 0, standard deviation 1e6) with the correlation `r` of neighbors.
std::vector<std::int64_t> series(std::size_t count, double r, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::int64_t> values;
  double x = normal(random);
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(std::llround(1e6 * x));
    x = r * x + std::sqrt(1.0 - r * r) * normal(random);
  }
  return values;
}

// Returns the share of the intervals that contain the true percentile.
double coverage(double r, double percent, double truth) {
  constexpr unsigned kRuns = 120;
  int covered = 0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const std::vector<std::int64_t> values = series(4000, r, run + 1);
    const std::optional<Interval> found = BlockBootstrap(values).interval(percent);
    covered += found && static_cast<double>(found->low) <= truth && truth <= static_cast<double>(found->high) ? 1 : 0;
  }
  return covered / static_cast<double>(kRuns);
}

// The nominal coverage is 95 %; with 120 runs, its standard error is 2 %, and intervals of high percentiles are
// slightly too narrow. Intervals for independent values would contain the median of the correlated series in half of
// the runs.
TEST(BlockBootstrap, IntervalsContainTheTruthAsOftenAsPromised) {
  for (const double r : {0.0, 0.8}) {
    const double median = coverage(r, 50.0, 0.0), p99 = coverage(r, 99.0, 2.3263e6);
    EXPECT_GE(median, 0.88) << r;
    EXPECT_LT(median, 1.0) << r;
    EXPECT_GE(p99, 0.84) << r;
    EXPECT_LT(p99, 1.0) << r;
  }
}

TEST(BlockBootstrap, IntervalsContainThePercentileAndNarrowWithMoreValues) {
  const std::vector<std::int64_t> many = series(40000, 0.5, 7);
  const std::span<const std::int64_t> few(many.data(), 2000);
  std::vector<std::int64_t> sorted = many;
  std::sort(sorted.begin(), sorted.end());
  for (const double percent : {50.0, 90.0, 99.0}) {
    const Interval wide = BlockBootstrap(few).interval(percent).value();
    const Interval narrow = BlockBootstrap(many).interval(percent).value();
    EXPECT_LT(narrow.high - narrow.low, 0.5 * static_cast<double>(wide.high - wide.low)) << percent;
    const std::int64_t value = percentile(std::span<const std::int64_t>(sorted), percent);
    EXPECT_LE(narrow.low, value);
    EXPECT_GE(narrow.high, value);
  }
}

TEST(BlockBootstrap, TooFewValuesGiveNoInterval) {
  EXPECT_FALSE(BlockBootstrap({}).interval(50.0).has_value());
  EXPECT_FALSE(BlockBootstrap(series(199, 0.0, 1)).interval(50.0).has_value());
  EXPECT_TRUE(BlockBootstrap(series(200, 0.0, 1)).interval(50.0).has_value());
  EXPECT_FALSE(BlockBootstrap(series(4000, 0.0, 1)).interval(99.9).has_value()) << "four values are above it";
  EXPECT_TRUE(BlockBootstrap(series(5000, 0.0, 1)).interval(99.9).has_value());
}

// Blocks of five values would end after the 200th; the 39 slow values behind it are a sixth of all.
TEST(BlockBootstrap, TheLastValuesCount) {
  std::vector<std::int64_t> values(200, 10);
  values.insert(values.end(), 39, 50);
  const Interval interval = BlockBootstrap(values).interval(90.0).value();
  EXPECT_EQ(interval.high, 50);
}

TEST(BlockBootstrap, EqualValuesGiveAPoint) {
  const Interval interval = BlockBootstrap(std::vector<std::int64_t>(1000, 42)).interval(90.0).value();
  EXPECT_EQ(interval.low, 42);
  EXPECT_EQ(interval.high, 42);
}

}  // namespace
}  // namespace touchline::statistics
