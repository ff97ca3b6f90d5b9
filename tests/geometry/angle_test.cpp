#include "core/geometry/angle.h"

#include <gtest/gtest.h>

namespace touchline {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Angle, IsWrappedIntoTheHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(wrap_angle(0.0), 0.0);
  EXPECT_DOUBLE_EQ(wrap_angle(kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(3.0 * kPi + 0.1), -kPi + 0.1, 1e-12);
  EXPECT_NEAR(wrap_angle(3.0 * kPi / 2.0), -kPi / 2.0, 1e-12);
  EXPECT_NEAR(wrap_angle(-3.0 * kPi / 2.0), kPi / 2.0, 1e-12);
  EXPECT_NEAR(wrap_angle(3.1 - -3.1), 6.2 - 2.0 * kPi, 1e-12);
  EXPECT_NEAR(wrap_angle(-7.0), -7.0 + 2.0 * kPi, 1e-12);
  for (int i = -1000; i <= 1000; ++i) {
    const double wrapped = wrap_angle(0.0371 * i);
    EXPECT_GT(wrapped, -kPi);
    EXPECT_LE(wrapped, kPi);
    EXPECT_NEAR(std::remainder(wrapped - 0.0371 * i, 2.0 * kPi), 0.0, 1e-9);
  }
}

TEST(Angle, WrapsFloatsAsWell) {
  constexpr float kFloatPi = std::numbers::pi_v<float>;
  EXPECT_FLOAT_EQ(wrap_angle(-kFloatPi), kFloatPi);
  EXPECT_FLOAT_EQ(wrap_angle(kFloatPi), kFloatPi);
  EXPECT_NEAR(wrap_angle(3 * kFloatPi + 0.1f), -kFloatPi + 0.1f, 1e-5f);
  EXPECT_FLOAT_EQ(wrap_angle(0.5f), 0.5f);
}

TEST(Angle, StaysInTheIntervalWhenRoundedToFloat) {
  for (const double angle : {kPi, -kPi, std::nextafter(kPi, 4.0), std::nextafter(-kPi, 0.0), 3.0 * kPi}) {
    const float wrapped = wrap_to_float(angle);
    EXPECT_LE(static_cast<double>(wrapped), kPi) << angle;
    EXPECT_GT(static_cast<double>(wrapped), -kPi) << angle;
    EXPECT_NEAR(std::abs(static_cast<double>(wrapped)), kPi, 1e-6);
  }
}

}  // namespace
}  // namespace touchline
