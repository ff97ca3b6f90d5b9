#include "hal/mock/random.h"

#include <gtest/gtest.h>

namespace touchline::hal::mock {
namespace {

constexpr int kDraws = 200000;

struct Moments {
  double mean = 0.0, variance = 0.0;
};

template <class Draw>
Moments moments_of(Draw draw) {
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = draw();
    sum += x;
    squares += x * x;
  }
  const double mean = sum / kDraws;
  return {mean, squares / kDraws - mean * mean};
}

// Values of an independent implementation, which reproduces the published numbers for the state 1, 2, 3, 4.
TEST(Random, SequenceIsThePublishedOne) {
  Random random(1, 2);
  EXPECT_EQ(random.bits(), 0xF6F50E5EA678C37CU);
  EXPECT_EQ(random.bits(), 0x68A2A4E91A1768A8U);
  EXPECT_EQ(random.bits(), 0x8C2A70B59C97CB7EU);
  EXPECT_EQ(random.bits(), 0x76D423E42E725F46U);
}

// Bounds: five standard deviations of the estimates.
TEST(Random, DistributionsHaveTheirMoments) {
  Random random(5, 1);
  const Moments uniform = moments_of([&] { return random.uniform(-1.0, 3.0); });
  EXPECT_NEAR(uniform.mean, 1.0, 0.013);
  EXPECT_NEAR(uniform.variance, 16.0 / 12.0, 0.014);
  const Moments normal = moments_of([&] { return random.normal(); });
  EXPECT_NEAR(normal.mean, 0.0, 0.0112);
  EXPECT_NEAR(normal.variance, 1.0, 0.0158);
  const Moments exponential = moments_of([&] { return random.exponential(); });
  EXPECT_NEAR(exponential.mean, 1.0, 0.0112);
  EXPECT_NEAR(exponential.variance, 1.0, 0.032);
  const Moments happens = moments_of([&] { return random.bernoulli(0.02) ? 1.0 : 0.0; });
  EXPECT_NEAR(happens.mean, 0.02, 0.0016);
}

TEST(Random, UniformStaysInItsBounds) {
  Random random(6, 1);
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
  }
}

TEST(Random, StreamsAndSeedsAreIndependent) {
  const auto correlation = [](Random a, Random b) {
    double sum = 0.0;
    for (int i = 0; i < kDraws; ++i) sum += a.normal() * b.normal();
    return sum / kDraws;
  };
  EXPECT_NEAR(correlation({1, 1}, {1, 2}), 0.0, 0.0112);
  EXPECT_NEAR(correlation({1, 1}, {2, 1}), 0.0, 0.0112);
  // A stream of one seed must differ from another seed's stream, too.
  EXPECT_NE(Random(1, 2).bits(), Random(2, 1).bits());
}

TEST(NormalTable, ContainsTheQuantiles) {
  const NormalTable table;
  double sum = 0.0, squares = 0.0;
  for (std::uint64_t i = 0; i < NormalTable::kSize; ++i) {
    const double x = static_cast<double>(table[i]);
    const double below = 0.5 * std::erfc(-x / std::numbers::sqrt2);
    ASSERT_NEAR(below * NormalTable::kSize, static_cast<double>(i) + 0.5, 0.1) << i;
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / NormalTable::kSize, 0.0, 1e-6);
  EXPECT_NEAR(squares / NormalTable::kSize, 1.0, 1e-3);
  EXPECT_LT(table[NormalTable::kSize - 1], 4.35f);
  EXPECT_GT(table[NormalTable::kSize - 1], 4.3f);
}

}  // namespace
}  // namespace touchline::hal::mock
