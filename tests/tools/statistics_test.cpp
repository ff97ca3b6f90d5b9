#include "tools/programs/statistics/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace touchline::statistics {
namespace {

TEST(Statistics, PercentileIsTheNearestRank) {
  const std::array<int, 5> five{15, 20, 35, 40, 50};
  EXPECT_EQ(percentile(std::span<const int>(five), 5.0), 15);
  EXPECT_EQ(percentile(std::span<const int>(five), 20.0), 15);
  EXPECT_EQ(percentile(std::span<const int>(five), 20.1), 20);
  EXPECT_EQ(percentile(std::span<const int>(five), 50.0), 35);
  EXPECT_EQ(percentile(std::span<const int>(five), 100.0), 50);
  std::vector<int> thousand(1000);
  std::iota(thousand.begin(), thousand.end(), 1);
  EXPECT_EQ(percentile(std::span<const int>(thousand), 99.9), 999);
  EXPECT_EQ(percentile(std::span<const int>(thousand), 99.91), 1000);
  const std::array<int, 1> one{7};
  EXPECT_EQ(percentile(std::span<const int>(one), 99.9), 7);
}

TEST(Statistics, SummaryOfKnownErrors) {
  std::vector<double> errors;
  for (int i = 1; i <= 100; ++i) errors.push_back(i % 2 == 0 ? i : -i);  // signs do not matter
  const ErrorSummary summary = summarize(errors);
  EXPECT_EQ(summary.count, 100u);
  EXPECT_NEAR(summary.rms, 58.1678605, 1e-6);  // sqrt(101 * 201 / 6)
  EXPECT_EQ(summary.p95, 95.0);
  EXPECT_EQ(summary.max, 100.0);
  EXPECT_EQ(summarize({}).count, 0u);
  EXPECT_EQ(summarize({}).max, 0.0);
}

TEST(Statistics, MediansTakeOneOfTheTwoMiddleValues) {
  std::vector<int> even{4, 1, 3, 2};
  EXPECT_EQ(median(even), 3);
  EXPECT_EQ(lower_median(even), 2);
  std::array<double, 3> odd{3.0, 1.0, 2.0};
  EXPECT_EQ(median(odd), 2.0);
  EXPECT_EQ(lower_median(odd), 2.0);
  std::vector<int> one{7};
  EXPECT_EQ(median(one), 7);
  EXPECT_EQ(lower_median(one), 7);
}

TEST(Statistics, MeanAndRootMeanSquare) {
  const std::vector<double> values{1.0, -3.0, 5.0};
  EXPECT_DOUBLE_EQ(mean(values), 1.0);
  EXPECT_DOUBLE_EQ(rms(values), std::sqrt(35.0 / 3.0));
  EXPECT_EQ(mean({}), 0.0);
  EXPECT_EQ(rms({}), 0.0);
}

}  // namespace
}  // namespace touchline::statistics
