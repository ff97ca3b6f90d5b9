#include "tools/programs/calibrate/field/vanishing_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibrate/arena_photograph.h"
#include "tools/programs/calibrate/field/paper_fit.h"

namespace touchline::calibrate {
namespace {

// The border for a lens without distortion and a floor that eq. (14) rectifies: a field of 2 x 1.5 m, rotated by 0.1
// rad in the picture, with these p and q.
BorderSearch seen_with(double p, double q) {
  const double scale = 200, turn = 0.1;
  BorderSearch border;
  border.h_px = kLargestH_px;
  const std::array<std::array<double, 2>, 4> floor{{{-1, -0.75}, {1, -0.75}, {1, 0.75}, {-1, 0.75}}};
  std::array<std::array<double, 2>, 4> at{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = scale * (floor[i][0] * std::cos(turn) - floor[i][1] * std::sin(turn));
    const double y = -scale * (floor[i][0] * std::sin(turn) + floor[i][1] * std::cos(turn));
    // Eq. (14) solved for X, Y.
    const double d = 1 + p * x + q * y;
    at[i] = {319.5 + x / d, 239.5 + y / d};
    border.straight_corners[i] = {static_cast<float>(at[i][0]), static_cast<float>(at[i][1])};
  }
  // Bottom, right, top, left.
  const std::array<std::array<std::size_t, 2>, 4> ends{{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& a = at[ends[i][0]];
    const auto& b = at[ends[i][1]];
    const double angle = std::atan2(b[0] - a[0], a[1] - b[1]);
    border.straight_sides[i] = {angle, a[0] * std::cos(angle) + a[1] * std::sin(angle), 100};
  }
  return border;
}

FieldParameters field_of(float length_m, float width_m) {
  FieldParameters field;
  field.length_m = length_m;
  field.width_m = width_m;
  return field;
}

TEST(VanishingPointModel, VanishingPointsGivePAndQ) {
  const double p = -2e-4, q = 5e-4;
  const auto steps = vanishing_point_model(seen_with(p, q), false, kWidth, kHeight, field_of(2.0f, 1.5f));
  ASSERT_TRUE(steps);
  EXPECT_NEAR(steps->p_per_px, p, 1e-7);
  EXPECT_NEAR(steps->q_per_px, q, 1e-7);
  // Both points lie on the line that eq. (14) sends to infinity.
  for (const VanishingPoint& v : {steps->along_x, steps->along_y}) EXPECT_NEAR(p * v.x + q * v.y, v.w, 1e-7);
  CameraParameters parameters;
  parameters.kind = CameraModelKind::kPaper;
  parameters.paper = steps->model;
  CameraModel camera;
  ASSERT_TRUE(camera.configure(parameters).ok());
  const FieldPoint corner = camera.to_field(seen_with(p, q).straight_corners[2], 0.0f);
  EXPECT_NEAR(static_cast<double>(corner.x_m), 1.0, 1e-4);
  EXPECT_NEAR(static_cast<double>(corner.y_m), 0.75, 1e-4);
}

TEST(VanishingPointModel, AVerticalCameraHasNoVanishingPoints) {
  const auto steps = vanishing_point_model(seen_with(0, 0), false, kWidth, kHeight, field_of(2.0f, 1.5f));
  ASSERT_TRUE(steps);
  EXPECT_NEAR(steps->p_per_px, 0, 1e-9);
  EXPECT_NEAR(steps->q_per_px, 0, 1e-9);
  EXPECT_NEAR(steps->rotation_rad, -0.1, 1e-6) << "v grows downwards";
}

TEST(VanishingPointModel, AreAccurateToCentimetersOnAPhotograph) {
  const hal::mock::ArenaParameters arena;
  BorderSearch border;
  ASSERT_EQ(find_border(photograph(arena, hal::mock::Floor::kField, 5), border).text(), "");
  const FieldParameters field =
      field_of(static_cast<float>(arena.field.length_m), static_cast<float>(arena.field.width_m));
  const auto steps = vanishing_point_model(border, false, kWidth, kHeight, field);
  ASSERT_TRUE(steps);
  const hal::mock::Lens lens(arena.camera);
  std::vector<FloorPoint> points;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-0.8, 0.0, 0.8}) {
      const auto [u, v] = lens.project({x, y, 0.0});
      points.push_back({x, y, u, v});
    }
  }
  EXPECT_LT(paper_residual(steps->model, points).max, 25.0);
}

}  // namespace
}  // namespace touchline::calibrate
