#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/marker/marker_layout.h"
#include "tests/marker/painted_field.h"

// Compares area, centroid and variances of the outlines with those of painted points.
namespace touchline::testing {
namespace {

struct Moments {
  double area = 0, x = 0, y = 0, major = 0, minor = 0, axis = 0;
};

Moments moments_of(const PatchPlace& place) {
  constexpr double kStep = 0.0002;
  Moments m;
  double xx = 0, xy = 0, yy = 0;
  int count = 0;
  for (int i = -500; i < 500; ++i) {
    for (int j = -500; j < 500; ++j) {
      const double x = (i + 0.5) * kStep, y = (j + 0.5) * kStep;
      if (!covers(place, {static_cast<float>(x), static_cast<float>(y)})) continue;
      ++count;
      m.x += x;
      m.y += y;
      xx += x * x;
      xy += x * y;
      yy += y * y;
    }
  }
  m.area = count * kStep * kStep;
  m.x /= count;
  m.y /= count;
  xx = xx / count - m.x * m.x;
  xy = xy / count - m.x * m.y;
  yy = yy / count - m.y * m.y;
  const double mean = (xx + yy) / 2, deviation = std::hypot((xx - yy) / 2, xy);
  m.major = mean + deviation;
  m.minor = mean - deviation;
  m.axis = 0.5 * std::atan2(2 * xy, xx - yy);
  return m;
}

TEST(Outline, AreaCentroidAndSpread) {
  for (const PatchOutline outline :
       {PatchOutline::kSquare, PatchOutline::kBar, PatchOutline::kTriangle, PatchOutline::kCircle}) {
    for (const auto& [length, width] : {std::pair(0.03f, 0.06f), std::pair(0.06f, 0.03f), std::pair(0.04f, 0.04f)}) {
      if (outline == PatchOutline::kCircle && length != width) continue;
      for (const float turn : {0.0f, 0.6f, -2.4f}) {
        const PatchPlace place{PatchRole::kTeam, outline, 0.01f, -0.005f, length, width, turn};
        const Moments m = moments_of(place);
        EXPECT_NEAR(area_m2(place), m.area, 0.01 * m.area);
        EXPECT_NEAR(m.x, 0.01, 1e-4);
        EXPECT_NEAR(m.y, -0.005, 1e-4);
        const PrincipalVariances s = principal_variances(place);
        EXPECT_NEAR(s.major_m2, m.major, 0.01 * m.major);
        EXPECT_NEAR(s.minor_m2, m.minor, 0.01 * m.minor);
        if (m.major < 1.1 * m.minor) continue;  // the axis is undefined
        EXPECT_NEAR(std::remainder(static_cast<double>(s.axis_rad) - m.axis, std::numbers::pi), 0.0, 0.01);
      }
    }
  }
}

TEST(Outline, ThePapersLayout) {
  const MarkerLayout layout = paper_layout();
  ASSERT_TRUE(validate(layout).ok());
  EXPECT_FLOAT_EQ(layout.robot_side_m, 0.075f);
  ASSERT_EQ(layout.patches.size(), 2u);
  const PatchPlace &team = layout.patches[0], &identification = layout.patches[1];
  EXPECT_EQ(team.role, PatchRole::kTeam);
  EXPECT_EQ(identification.role, PatchRole::kIdentification);
  // Diagonally opposite, so that eq. (3) gives the center and, after its -45 degrees, forward.
  EXPECT_FLOAT_EQ(team.x_m + identification.x_m, 0.0f);
  EXPECT_FLOAT_EQ(team.y_m + identification.y_m, 0.0f);
  EXPECT_FLOAT_EQ(std::atan2(team.y_m - identification.y_m, team.x_m - identification.x_m),
                  std::numbers::pi_v<float> / 4);
}

}  // namespace
}  // namespace touchline::testing
