#include "core/marker/simd4.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace touchline::testing {
namespace {

TEST(Simd4, LogarithmIsExactToALastPlaceInEachLane) {
  float largest = 0;
  for (float x = std::numeric_limits<float>::min(); x < 1e30f; x *= 1.00037f) {
    const Simd4<float> four{x, 1.0f / (1.0f + x), 1.0f + x, 0.7f + std::fmod(x, 0.8f)};
    const Simd4<float> result = logarithm(four);
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const double truth = std::log(static_cast<double>(four[lane]));
      const double last_place = std::ldexp(1.0, std::max(std::ilogb(truth), -24) - 23);
      const auto error = static_cast<float>(std::abs(static_cast<double>(result[lane]) - truth) / last_place);
      largest = std::max(largest, error);
    }
  }
  EXPECT_GT(largest, 0.4f);
  EXPECT_LT(largest, 1.5f);
  EXPECT_EQ(logarithm(Simd4<float>{} + 1.0f)[3], 0.0f);
}

TEST(Simd4, BitsAreThoseOfTheLanes) {
  for (std::uint32_t bits = 0; bits < 16; ++bits) {
    Simd4<std::int32_t> lanes{};
    for (std::uint32_t lane = 0; lane < 4; ++lane) lanes[lane] = (bits >> lane & 1u) != 0 ? -1 : 0;
    EXPECT_EQ(bits_of(lanes), bits);
  }
}

}  // namespace
}  // namespace touchline::testing
