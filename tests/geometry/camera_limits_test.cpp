// Invalid camera parameters, and points that no camera sees.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/geometry/reference_camera.h"

namespace touchline::testing {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

CameraParameters full() {
  FullCamera camera{{0.1, 0.2, 0, {0, -0.4, 2}}, {}};
  camera.lens.fx_px = camera.lens.fy_px = 400;
  camera.lens.cx_px = 319.5f;
  camera.lens.cy_px = 239.5f;
  camera.lens.k1 = -0.2f;
  camera.lens.p1 = 1e-3f;
  return camera.parameters();
}
CameraParameters paper() { return PaperCamera{{0.1, 0.2, 0, {0, -0.4, 2}}}.parameters(); }

ErrorCode refusal(const CameraParameters& parameters) {
  CameraModel model;
  return model.configure(parameters).code();
}

TEST(CameraLimits, EveryNumberMustBeFinite) {
  ASSERT_EQ(refusal(full()), ErrorCode::kOk);
  ASSERT_EQ(refusal(paper()), ErrorCode::kOk);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    CameraParameters p = full();
    FullModelParameters& f = p.full;
    for (float* number :
         {&f.fx_px, &f.fy_px, &f.cx_px, &f.cy_px, &f.k1, &f.k2, &f.k3, &f.p1, &f.p2, &f.rotation_rad[0],
          &f.rotation_rad[1], &f.rotation_rad[2], &f.position_m[0], &f.position_m[1], &f.position_m[2]}) {
      const float good = std::exchange(*number, bad);
      EXPECT_EQ(refusal(p), ErrorCode::kOutOfRange) << (number - &f.fx_px);
      *number = good;
    }
    p = paper();
    PaperModelParameters& q = p.paper;
    for (float* number : {&q.center_u_px, &q.center_v_px, &q.focal_px, &q.p_per_px, &q.q_per_px, &q.affine[0],
                          &q.affine[1], &q.affine[2], &q.affine[3], &q.affine[4], &q.affine[5], &q.position_m[0],
                          &q.position_m[1], &q.position_m[2]}) {
      const float good = std::exchange(*number, bad);
      EXPECT_EQ(refusal(p), ErrorCode::kOutOfRange) << (number - &q.center_u_px);
      *number = good;
    }
  }
}

TEST(CameraLimits, FocalLengthsAndCameraHeightMustBePositive) {
  EXPECT_EQ(refusal({}), ErrorCode::kOutOfRange) << "nothing is calibrated yet";
  for (const float bad : {0.0f, -1.0f}) {
    CameraParameters p = full();
    for (float* number : {&p.full.fx_px, &p.full.fy_px, &p.full.position_m[2]}) {
      const float good = std::exchange(*number, bad);
      EXPECT_EQ(refusal(p), ErrorCode::kOutOfRange);
      *number = good;
    }
    p = paper();
    for (float* number : {&p.paper.focal_px, &p.paper.position_m[2]}) {
      const float good = std::exchange(*number, bad);
      EXPECT_EQ(refusal(p), ErrorCode::kOutOfRange);
      *number = good;
    }
  }
}

TEST(CameraLimits, TheAffinePartMustBeInvertible) {
  CameraParameters p = paper();
  p.paper.affine = {};
  EXPECT_EQ(refusal(p), ErrorCode::kInconsistent);
  p.paper.affine = {1e-3f, 2e-3f, 0, 2e-3f, 4e-3f, 0};
  EXPECT_EQ(refusal(p), ErrorCode::kInconsistent);
  p.paper.affine = {1e-3f, 0, 0, 5e-3f, 0, 0};
  EXPECT_EQ(refusal(p), ErrorCode::kInconsistent);
  // For any size of a pixel.
  p.paper.affine = {1e-6f, 0, 0, 0, -1e-6f, 0};
  EXPECT_EQ(refusal(p), ErrorCode::kOk);
}

TEST(CameraLimits, AnErrorLeavesTheModelUnchanged) {
  CameraModel model, untouched;
  ASSERT_TRUE(model.configure(full()).ok());
  ASSERT_TRUE(untouched.configure(full()).ok());
  CameraParameters bad = paper();
  bad.paper.affine = {};
  EXPECT_FALSE(model.configure(bad).ok());
  bad = full();
  bad.full.fx_px = 100;
  bad.full.position_m[2] = 0;
  EXPECT_FALSE(model.configure(bad).ok());
  for (const PixelPoint pixel : whole_picture()) {
    EXPECT_EQ(model.to_field(pixel, 0.05f).x_m, untouched.to_field(pixel, 0.05f).x_m);
    EXPECT_EQ(model.to_field(pixel, 0.05f).y_m, untouched.to_field(pixel, 0.05f).y_m);
  }
}

// Cameras: valid ones, one that looks horizontally, one that looks up, and the limits of the venue file.
std::vector<CameraParameters> all_kinds() {
  std::vector<CameraParameters> out{full(), paper()};
  for (const double pitch : {-1.5708, -2.5, 3.14159}) {
    FullCamera camera{{0, pitch, 0, {0, 0, 2}}, {}};
    camera.lens.fx_px = camera.lens.fy_px = 300;
    out.push_back(camera.parameters());
  }
  CameraParameters extreme = full();
  extreme.full.fx_px = 1e-3f;
  extreme.full.k1 = 10;
  extreme.full.k2 = -100;
  extreme.full.k3 = 1000;
  extreme.full.p1 = extreme.full.p2 = 1;
  out.push_back(extreme);
  extreme = paper();
  extreme.paper.focal_px = 1e-3f;
  extreme.paper.p_per_px = -1;
  extreme.paper.q_per_px = 1;
  out.push_back(extreme);
  extreme.paper.affine = {100, -100, 100, 99, 100, -100};
  out.push_back(extreme);
  return out;
}

TEST(CameraLimits, FiniteArgumentsGiveFiniteResults) {
  constexpr std::array<float, 11> kNumbers{-kLargest, -1e20f, -1e4f,  -1.0f, -1e-30f, 0.0f,
                                           1e-30f,    0.3f,   319.5f, 1e6f,  kLargest};
  constexpr std::array<float, 7> kAnyHeight{-kLargest, -1.0f, 0.0f, 0.075f, 2.0f, 5.0f, kLargest};
  for (const CameraParameters& parameters : all_kinds()) {
    CameraModel model;
    ASSERT_TRUE(model.configure(parameters).ok());
    for (const float a : kNumbers) {
      for (const float b : kNumbers) {
        const Ray ray = model.ray({a, b});
        for (const float d : ray.direction) EXPECT_TRUE(std::isfinite(d)) << a << ' ' << b;
        EXPECT_LT(ray.direction[2], 0.0f) << a << ' ' << b;
        for (const float height : kAnyHeight) {
          const FieldPoint field = model.to_field({a, b}, height);
          const PixelPoint pixel = model.to_pixel({a, b}, height);
          EXPECT_TRUE(std::isfinite(field.x_m) && std::isfinite(field.y_m)) << a << ' ' << b << ' ' << height;
          EXPECT_TRUE(std::isfinite(pixel.u_px) && std::isfinite(pixel.v_px)) << a << ' ' << b << ' ' << height;
          EXPECT_TRUE(std::isfinite(model.scale_px_per_m({a, b}, height))) << a << ' ' << b << ' ' << height;
        }
      }
    }
  }
}

TEST(CameraLimits, PlanesAtOrAboveTheCameraAreMovedJustBelowIt) {
  for (const CameraParameters& parameters : {full(), paper()}) {
    CameraModel model;
    ASSERT_TRUE(model.configure(parameters).ok());
    const FieldPoint below = model.to_field({500, 100}, 0.999f * 2.0f), at = model.to_field({500, 100}, 2.0f);
    EXPECT_NEAR(static_cast<double>(at.x_m), static_cast<double>(below.x_m), 1e-5);
    EXPECT_NEAR(static_cast<double>(at.y_m), static_cast<double>(below.y_m), 1e-5);
    EXPECT_EQ(model.to_field({500, 100}, 7.0f).x_m, at.x_m);
  }
}

TEST(CameraLimits, PointsBehindTheCameraAreNotInThePicture) {
  // A horizontal camera with half of the field behind it, which without a check would appear mirrored in front of it.
  FullCamera camera{{0, -1.2, 0, {0, 0, 1}}, {}};
  camera.lens.fx_px = camera.lens.fy_px = 300;
  camera.lens.cx_px = 319.5f;
  camera.lens.cy_px = 239.5f;
  CameraModel model;
  ASSERT_TRUE(model.configure(camera.parameters()).ok());
  const PixelPoint front = model.to_pixel({0.1f, 1.5f}, 0), behind = model.to_pixel({0.1f, -1.5f}, 0);
  EXPECT_TRUE(front.v_px > 0 && front.v_px < kHeight) << front.v_px;
  EXPECT_GT(behind.v_px, static_cast<float>(kHeight)) << "below the lower border";
}

}  // namespace
}  // namespace touchline::testing
