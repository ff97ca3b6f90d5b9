#include "core/geometry/sight_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/geometry/reference_camera.h"
#include "tests/geometry/round_trip.h"

namespace touchline::testing {
namespace {

constexpr PixelPoint kFirst{0, 0}, kLast{640, 480};

// A tilted camera with a lens of 85 degrees across the picture, which bends lines strongly.
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

constexpr std::array<float, 3> kHeights_m{0.0f, 0.06f, 0.15f};

struct Errors {
  double place_px = 0, scale = 0;  // scale: relative
  int unknown = 0, pixels = 0;
};

// The largest errors over the rectangle.
Errors largest_errors(const CameraModel& camera) {
  SightTable table;
  table.configure(camera, kFirst, kLast);
  Errors largest;
  for (float v = 0.5f; v < kLast.v_px; v += 3.3f) {
    for (float u = 0.5f; u < kLast.u_px; u += 3.7f) {
      ++largest.pixels;
      SightLine line;
      if (!table.find({u, v}, line)) {
        ++largest.unknown;
        continue;
      }
      for (const float height_m : kHeights_m) {
        const double scale = static_cast<double>(line.scale_px_per_m(height_m)) /
                             static_cast<double>(camera.scale_px_per_m(line.at(height_m), height_m));
        largest.place_px = std::max(largest.place_px, distance(camera.to_pixel(line.at(height_m), height_m), {u, v}));
        largest.scale = std::max(largest.scale, std::abs(scale - 1.0));
      }
    }
  }
  return largest;
}

TEST(SightTable, AgreesWithTheCameraModel) {
  for (const CameraModel& camera : {wide_lens(), paper_lens()}) {
    const Errors errors = largest_errors(camera);
    EXPECT_LT(errors.place_px, 1.5 * static_cast<double>(SightTable::kLargestError_px));
    EXPECT_LT(errors.scale, 0.002);
    EXPECT_LT(errors.unknown, errors.pixels / 20);
  }
}

TEST(SightTable, LeavesOutWhatItDoesNotKnowExactly) {
  // The camera's horizon is in the picture, where points on the field are infinitely far.
  FullCamera camera;
  camera.pinhole = {.yaw_rad = 0, .pitch_rad = 1.2, .roll_rad = 0, .position_m = {0, -2, 1.5}};
  camera.lens.fx_px = camera.lens.fy_px = 500;
  camera.lens.cx_px = 320;
  camera.lens.cy_px = 240;
  const Errors errors = largest_errors(model_of(camera.parameters()));
  EXPECT_GT(errors.unknown, errors.pixels / 10);
  EXPECT_LT(errors.unknown, errors.pixels / 2);
  EXPECT_LT(errors.place_px, 2.0 * static_cast<double>(SightTable::kLargestError_px));
}

TEST(SightTable, KnowsNothingOutsideOfItsRectangle) {
  SightTable table;
  SightLine line({1, 2, 3}, 0, 0, 0);
  EXPECT_FALSE(table.find({320, 240}, line)) << "not configured";
  table.configure(wide_lens(), {100, 50}, {600, 400});
  for (const PixelPoint outside : std::vector<PixelPoint>{{99, 200}, {601, 200}, {300, 49}, {300, 401}, {NAN, 200}}) {
    EXPECT_FALSE(table.find(outside, line)) << outside.u_px << ' ' << outside.v_px;
  }
  EXPECT_EQ(line.at(0).x_m, 1) << "unchanged";
}

}  // namespace
}  // namespace touchline::testing
