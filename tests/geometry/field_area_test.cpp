#include "core/geometry/field_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace touchline {
namespace {

// Powers of two, so that the edges are exact: 2 m x 1.5 m, goals 0.5 m wide and 0.125 m deep, margin 1/16 m.
constexpr FieldParameters kField{2.0f, 1.5f, 0.5f, 0.125f, 0.0625f};
constexpr float kX = 1.0625f, kY = 0.8125f, kGoalX = 1.1875f, kGoalY = 0.3125f;

float beyond(float value) { return std::nextafter(value, std::numeric_limits<float>::infinity()); }

// The four points that differ only in signs.
int inside(const FieldParameters& field, float x, float y) {
  return int{inside_field(field, {x, y})} + int{inside_field(field, {-x, y})} + int{inside_field(field, {x, -y})} +
         int{inside_field(field, {-x, -y})};
}

TEST(FieldArea, BorderWithItsMarginBelongsToTheField) {
  EXPECT_EQ(inside(kField, 0, 0), 4);
  EXPECT_EQ(inside(kField, kX, kY), 4);
  EXPECT_EQ(inside(kField, beyond(kX), kY), 0);
  EXPECT_EQ(inside(kField, kX, beyond(kY)), 0);
  EXPECT_EQ(inside(kField, 0, beyond(kY)), 0);
}

TEST(FieldArea, GoalsWithTheirMarginBelongToTheField) {
  EXPECT_EQ(inside(kField, kGoalX, 0), 4);
  EXPECT_EQ(inside(kField, kGoalX, kGoalY), 4);
  EXPECT_EQ(inside(kField, beyond(kGoalX), 0), 0);
  EXPECT_EQ(inside(kField, kGoalX, beyond(kGoalY)), 0);
  EXPECT_EQ(inside(kField, beyond(kX), beyond(kGoalY)), 0);
}

TEST(FieldArea, WithoutMarginTheLinesAreTheEdge) {
  FieldParameters field = kField;
  field.margin_m = 0;
  EXPECT_EQ(inside(field, 1.0f, 0.75f), 4);
  EXPECT_EQ(inside(field, 1.0f, beyond(0.75f)), 0);
  EXPECT_EQ(inside(field, 1.125f, 0.25f), 4);
  EXPECT_EQ(inside(field, beyond(1.125f), 0.25f), 0);
}

TEST(FieldArea, AGoalWithoutWidthOrDepthAddsNothing) {
  FieldParameters field = kField;
  field.goal_width_m = 0;
  EXPECT_EQ(inside(field, beyond(kX), 0), 0);
  field = kField;
  field.goal_depth_m = 0;
  EXPECT_EQ(inside(field, beyond(kX), 0), 0);
}

TEST(FieldArea, NaNIsOutside) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (const float bad : {kNaN, kInfinity}) {
    EXPECT_EQ(inside(kField, bad, 0), 0);
    EXPECT_EQ(inside(kField, 0, bad), 0);
    EXPECT_EQ(inside(kField, bad, bad), 0);
  }
}

}  // namespace
}  // namespace touchline
