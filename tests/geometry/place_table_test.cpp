#include "core/geometry/place_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/geometry/reference_camera.h"
#include "tests/geometry/round_trip.h"

namespace touchline::testing {
namespace {

constexpr PixelPoint kFirst{0, 0}, kLast{640, 480};

// A lens of 85 degrees across the picture, in which lines bend strongly, tilted.
CameraModel wide_lens() {
  FullCamera camera;
  camera.pinhole = {.yaw_rad = 0.1, .pitch_rad = 0.08, .roll_rad = -0.05, .position_m = {0.1, -0.2, 2.1}};
  camera.lens.fx_px = camera.lens.fy_px = 400;
  camera.lens.cx_px = 318;
  camera.lens.cy_px = 243;
  camera.lens.k1 = -0.2f;
  camera.lens.k2 = 0.03f;
  return model_of(camera.parameters());
}

CameraModel paper_lens() {
  PaperCamera camera;
  camera.pinhole = {.yaw_rad = -0.2, .pitch_rad = 0.05, .roll_rad = 0.07, .position_m = {0, 0, 2.4}};
  return model_of(camera.parameters());
}

// The largest error over the rectangle, in px.
float largest_error_px(const CameraModel& camera) {
  PlaceTable table;
  table.configure(camera, kFirst, kLast);
  float largest = 0;
  for (float v = 0.5f; v < kLast.v_px; v += 3.3f) {
    for (float u = 0.5f; u < kLast.u_px; u += 3.7f) {
      for (const float height_m : {0.0f, 0.06f, 0.15f}) {
        FieldPoint at;
        EXPECT_TRUE(table.find({u, v}, height_m, at));
        const PixelPoint seen = camera.to_pixel(at, height_m);
        largest = std::max(largest, std::hypot(seen.u_px - u, seen.v_px - v));
      }
    }
  }
  return largest;
}

TEST(PlaceTable, IsExactToAFractionOfAPixel) {
  EXPECT_LT(largest_error_px(wide_lens()), 0.4f);
  EXPECT_LT(largest_error_px(paper_lens()), 0.2f);
}

TEST(PlaceTable, IsExactAtItsNodes) {
  const CameraModel camera = wide_lens();
  PlaceTable table;
  table.configure(camera, kFirst, kLast);
  FieldPoint at;
  ASSERT_TRUE(table.find({320, 240}, 0.06f, at));
  const FieldPoint exact = camera.to_field({320, 240}, 0.06f);
  EXPECT_NEAR(at.x_m, exact.x_m, 1e-6);
  EXPECT_NEAR(at.y_m, exact.y_m, 1e-6);
}

TEST(PlaceTable, KnowsNothingOutsideOfItsRectangle) {
  PlaceTable table;
  FieldPoint at{7, 8};
  EXPECT_FALSE(table.find({320, 240}, 0.0f, at)) << "not configured";
  table.configure(wide_lens(), {100, 50}, {600, 400});
  for (const PixelPoint outside : std::vector<PixelPoint>{{99, 200}, {601, 200}, {300, 49}, {300, 401}, {NAN, 200}}) {
    EXPECT_FALSE(table.find(outside, 0.0f, at)) << outside.u_px << ' ' << outside.v_px;
  }
  EXPECT_EQ(at.x_m, 7);
  EXPECT_EQ(at.y_m, 8);
}

}  // namespace
}  // namespace touchline::testing
