#include "tools/programs/rectify/rectification.h"

#include <gtest/gtest.h>

#include "tests/rectify/distorted_field.h"
#include "tests/results.h"
#include "tools/programs/rectify/straightness.h"

namespace touchline::rectify {
namespace {

CameraParameters of_kind(CameraModelKind kind) {
  CameraParameters camera = distorted_camera();
  camera.kind = kind;
  return camera;
}

CameraModel model_of(const CameraParameters& parameters) {
  CameraModel model;
  EXPECT_TRUE(model.configure(parameters).ok());
  return model;
}

TEST(LensMap, ImplementsEquationTwelveForThePapersModel) {
  const LensMap lens(of_kind(CameraModelKind::kPaper));
  // Klancar eq. (12): R = H sinh(r / H), here with H = 250 and r = 100 along the row.
  EXPECT_NEAR(lens.undistorted({259.5, 119.5})[0], 159.5 + 250 * std::sinh(0.4), 1e-4);
  EXPECT_NEAR(lens.undistorted({259.5, 119.5})[1], 119.5, 1e-9);
}

TEST(LensMap, BendingIsTheInverseOfStraightening) {
  for (const auto kind : {CameraModelKind::kFull, CameraModelKind::kPaper}) {
    const LensMap lens(of_kind(kind));
    for (const Point& p : {Point{3, 5}, Point{310, 7}, Point{160, 230}, Point{159.5, 119.5}}) {
      const Point back = lens.distorted(lens.undistorted(p));
      EXPECT_NEAR(back[0], p[0], 1e-4);
      EXPECT_NEAR(back[1], p[1], 1e-4);
    }
  }
}

TEST(Rectification, TheRectifiedFloorIsToScale) {
  const hal::Picture seen = photograph(distorted_camera(), small_field());
  Raster raster;
  ASSERT_OK_AND_ASSIGN(const hal::Picture floor,
                       rectify_floor(seen, model_of(distorted_camera()), small_field(), 0.1, 200, raster));
  EXPECT_EQ(floor.width_px, 380u);  // (1.5 + 2 * (0.1 + 0.1)) * 200
  EXPECT_EQ(floor.height_px, 300u);
  const auto value = [&](double x_m, double y_m) {
    const auto column = static_cast<std::size_t>(std::lround((x_m - raster.left) * raster.scale));
    const auto row = static_cast<std::size_t>(std::lround((raster.top - y_m) * raster.scale));
    return static_cast<int>(floor.rgb8[3 * (row * floor.width_px + column)]);
  };
  for (const double side : {-1.0, 1.0}) {
    for (const double along : {-0.5, 0.0, 0.5}) {
      EXPECT_LT(value(side * 0.735, along), 90) << "field";
      EXPECT_GT(value(side * 0.775, along), 200) << "border";
      EXPECT_LT(value(along, side * 0.635), 90) << "field";
      EXPECT_GT(value(along, side * 0.675), 200) << "border";
    }
  }
  EXPECT_EQ(rectify_floor(seen, model_of(distorted_camera()), small_field(), 0.1, 10000, raster).code(),
            ErrorCode::kFull);
}

TEST(Rectification, TheStraightenedPictureContainsTheWholeUpToTwiceTheSize) {
  const hal::Picture seen = photograph(distorted_camera(), small_field());
  Raster raster;
  hal::Picture straight = straighten(seen, LensMap(distorted_camera()), raster);
  EXPECT_GT(straight.width_px, kWidth);
  EXPECT_LT(straight.width_px, 2 * kWidth);
  CameraParameters fisheye = of_kind(CameraModelKind::kPaper);
  fisheye.paper.focal_px = 40;
  straight = straighten(seen, LensMap(fisheye), raster);
  EXPECT_LE(straight.width_px, 2 * kWidth);
  EXPECT_LE(straight.height_px, 2 * kHeight);
}

TEST(Straightness, DeviationsFallWithTheRightModelOnly) {
  const hal::Picture seen = photograph(distorted_camera(), small_field());
  const CameraModel camera = model_of(distorted_camera());
  std::array<std::size_t, 4> left_out{};
  const auto points = border_points(seen, camera, small_field(), left_out);
  for (const SideStraightness& side : straightness(points, left_out, camera, LensMap(distorted_camera()), 150)) {
    EXPECT_GT(side.points, 40u);
    EXPECT_EQ(side.left_out, 0u);
    EXPECT_GT(side.distorted.rms_px, 0.7);
    EXPECT_LT(side.straightened.rms_px, 0.12);
    EXPECT_LT(side.rectified.rms_mm, 0.8);
    // Both are the same deviation in millimeters, because the camera is nearly vertical.
    EXPECT_NEAR(side.straightened.rms_mm, side.rectified.rms_mm, 0.05);
    EXPECT_NEAR(side.rectified.rms_px, side.rectified.rms_mm * 0.15, 1e-6);
  }
  CameraParameters straight_lens = distorted_camera();
  straight_lens.full.k1 = 0;
  straight_lens.full.k2 = 0;
  for (const SideStraightness& side :
       straightness(points, left_out, model_of(straight_lens), LensMap(straight_lens), 150)) {
    EXPECT_GT(side.rectified.rms_px, 0.5);
  }
}

TEST(Straightness, IgnoresObjectsInFrontOfTheBorder) {
  hal::Picture seen = photograph(distorted_camera(), small_field());
  const CameraModel camera = model_of(distorted_camera());
  // A bright object of 12 x 8 pixels that extends 4 pixels from the lower border into the field.
  const PixelPoint at = camera.to_pixel({0.2f, -0.65f}, 0.0f);
  for (int dv = -4; dv < 4; ++dv) {
    const auto first = 3 * (static_cast<std::ptrdiff_t>(at.v_px) + dv) * std::ptrdiff_t{kWidth} +
                       3 * static_cast<std::ptrdiff_t>(at.u_px);
    std::fill_n(seen.rgb8.begin() + first, 36, std::uint8_t{230});
  }
  std::array<std::size_t, 4> left_out{};
  const auto points = border_points(seen, camera, small_field(), left_out);
  EXPECT_GE(left_out[0], 2u);
  const auto sides = straightness(points, left_out, camera, LensMap(distorted_camera()), 150);
  EXPECT_LT(sides[0].rectified.rms_mm, 1.0);
}

}  // namespace
}  // namespace touchline::rectify
