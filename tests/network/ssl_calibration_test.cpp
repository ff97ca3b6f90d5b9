// SSL-Vision's camera model, fitted to ours: how far the points on the field differ.
#include "firmware/network/ssl_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

SslCalibration fitted(const VenueGeometry& geometry) {
  SslCalibration calibration;
  EXPECT_TRUE(
      fit_ssl_calibration(geometry.camera, geometry.field, geometry.width_px, geometry.height_px, 0.075f, calibration)
          .ok());
  return calibration;
}

/// The formulas of SSL-Vision's CameraParameters::field2image (src/shared/util/camera_calibration.cpp, commit 0fa6168),
/// written independently of our code: quaternion rotation by products, and the distortion by bisection.
PixelPoint field_to_image(const SslCalibration& c, FieldPoint point, float height_m) {
  const auto millimeters = [](float length_m) { return 1000.0 * static_cast<double>(length_m); };
  const std::array<double, 3> p{millimeters(point.x_m), millimeters(point.y_m), millimeters(height_m)};
  const auto [x, y, z, w] = c.q;
  const auto cross = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::array<double, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  // v' = v + 2 w (q x v) + 2 q x (q x v)
  const std::array<double, 3> axis{x, y, z}, once = cross(axis, p), twice = cross(axis, once);
  std::array<double, 3> camera{};
  for (std::size_t i = 0; i < 3; ++i) camera[i] = p[i] + 2.0 * w * once[i] + 2.0 * twice[i] + c.t_mm[i];
  const double u = camera[0] / camera[2], v = camera[1] / camera[2], ideal = std::hypot(u, v);
  double low = 0.0, high = ideal;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (middle * (1.0 + c.distortion * middle * middle) < ideal ? low : high) = middle;
  }
  const double scale = ideal > 0.0 ? c.focal_length_px * low / ideal : 0.0;
  return {static_cast<float>(c.principal_point_px[0] + scale * u),
          static_cast<float>(c.principal_point_px[1] + scale * v)};
}

TEST(SslCalibration, APinholeCameraIsExact) {
  VenueGeometry geometry = example_geometry();
  FullModelParameters& camera = geometry.camera.full;
  camera.fy_px = camera.fx_px;
  camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0.0f;
  const SslCalibration calibration = fitted(geometry);
  EXPECT_LT(calibration.max_mm, 0.01);
  EXPECT_NEAR(calibration.focal_length_px, 559.05, 0.1);
  EXPECT_NEAR(calibration.position_mm[2], 2296.69, 0.5);
  EXPECT_NEAR(calibration.distortion, 0.0, 1e-4);
}

TEST(SslCalibration, ALensOfTheMockBoardIsApproximated) {
  const SslCalibration calibration = fitted(example_geometry());
  RecordProperty("rms_um", static_cast<int>(calibration.rms_mm * 1000.0));
  RecordProperty("max_um", static_cast<int>(calibration.max_mm * 1000.0));
  // docs/network.md states these figures.
  EXPECT_GT(calibration.rms_mm, 0.05);
  EXPECT_LT(calibration.rms_mm, 2.0);
  EXPECT_LT(calibration.max_mm, 6.0);
  EXPECT_GT(calibration.distortion, 0.1);
}

TEST(SslCalibration, AgreesWithTheReceiversFormulas) {
  const VenueGeometry geometry = example_geometry();
  const SslCalibration calibration = fitted(geometry);
  for (const float height_m : {0.0f, 0.075f}) {
    for (const FieldPoint point : {FieldPoint{0.0f, 0.0f}, FieldPoint{1.0f, 0.8f}, FieldPoint{-1.0f, 0.5f}}) {
      const PixelPoint pixel = field_to_image(calibration, point, height_m);
      const FieldPoint back = to_field(calibration, pixel, height_m);
      EXPECT_NEAR(back.x_m, point.x_m, 1e-5f);
      EXPECT_NEAR(back.y_m, point.y_m, 1e-5f);
      CameraModel ours;
      ASSERT_TRUE(ours.configure(geometry.camera).ok());
      const FieldPoint truth = ours.to_field(pixel, height_m);
      EXPECT_NEAR(std::hypot(truth.x_m - point.x_m, truth.y_m - point.y_m), 0.0, 1.2e-3 * calibration.max_mm);
    }
  }
}

TEST(SslCalibration, APincushionLensIsFittedWithoutDistortion) {
  VenueGeometry geometry = example_geometry();
  FullModelParameters& camera = geometry.camera.full;
  camera.k1 = 0.05f;
  camera.k2 = camera.k3 = 0.0f;
  const SslCalibration calibration = fitted(geometry);
  EXPECT_EQ(calibration.distortion, 0.0);
  EXPECT_LT(calibration.max_mm, 20.0);
}

TEST(SslCalibration, ThePaperModelIsFittedToo) {
  VenueGeometry geometry = example_geometry();
  geometry.camera.kind = CameraModelKind::kPaper;
  // A camera straight above the center, 2.3 m high, whose rows point in direction x and columns against y.
  geometry.camera.paper = {.center_u_px = 320.0f,
                           .center_v_px = 240.0f,
                           .focal_px = 600.0f,
                           .p_per_px = 0.0f,
                           .q_per_px = 0.0f,
                           .affine = {2.3f / 560.0f, 0.0f, 0.0f, 0.0f, -2.3f / 560.0f, 0.0f},
                           .position_m = {0.0f, 0.0f, 2.3f}};
  const SslCalibration calibration = fitted(geometry);
  EXPECT_LT(calibration.rms_mm, 3.0);
  EXPECT_NEAR(calibration.position_mm[2], 2300.0, 60.0);
}

}  // namespace
}  // namespace touchline::network
