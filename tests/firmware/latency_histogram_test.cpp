#include "firmware/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace touchline {
namespace {

using namespace std::chrono_literals;

TEST(LatencyHistogram, PercentilesHaveTheAccuracyOfABin) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> milliseconds(1.0, 1.5);
  LatencyHistogram histogram;
  std::vector<Duration> all;
  for (int i = 0; i < 20000; ++i) {
    all.push_back(from_seconds(milliseconds(random) * 1e-3));
    histogram.add(all.back());
  }
  std::sort(all.begin(), all.end());
  for (const double fraction : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(all.size()))) - 1;
    const double ratio = seconds(histogram.percentile(fraction)) / seconds(all[rank]);
    EXPECT_GE(ratio, 1.0) << fraction;
    EXPECT_LE(ratio, 1.0 + 1.0 / 64.0) << fraction;
  }
  EXPECT_EQ(histogram.percentile(1.0), all.back());
  EXPECT_EQ(histogram.max(), all.back());
  EXPECT_EQ(histogram.count(), all.size());
}

TEST(LatencyHistogram, ShortDurationsAreExact) {
  LatencyHistogram histogram;
  for (int ns = 0; ns < 64; ++ns) histogram.add(Duration(ns));
  EXPECT_EQ(histogram.percentile(0.5), 31ns);
  EXPECT_EQ(histogram.percentile(1.0), 63ns);
}

TEST(LatencyHistogram, ExtremeDurationsAreCounted) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile(0.5), 0ns);
  histogram.add(-5ms);
  EXPECT_EQ(histogram.percentile(1.0), 0ns);
  histogram.add(std::chrono::hours(1000));
  EXPECT_EQ(histogram.max(), std::chrono::hours(1000));
  EXPECT_GE(histogram.percentile(1.0), 137s);
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.max(), 0ns);
}

}  // namespace
}  // namespace touchline
