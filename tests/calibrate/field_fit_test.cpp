#include "tools/programs/calibrate/field/field_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace touchline::calibrate {
namespace {

constexpr double kLength_m = 2.2, kWidth_m = 1.8;

// A camera above the field at the given position, tilted about the horizontal axis of the picture.
CameraParameters camera_at(double x_m, double y_m, double z_m, double tilt_rad, double focal_px, double k1 = 0.0) {
  CameraParameters p;
  p.kind = CameraModelKind::kFull;
  p.full.fx_px = p.full.fy_px = static_cast<float>(focal_px);
  p.full.cx_px = 319.5f;
  p.full.cy_px = 239.5f;
  p.full.k1 = static_cast<float>(k1);
  const double pi = std::acos(-1.0);
  // A camera that points straight down is rotated by pi about x.
  const Eigen::AngleAxisd turn(Eigen::AngleAxisd(pi - tilt_rad, Eigen::Vector3d::UnitX()));
  for (int i = 0; i < 3; ++i)
    p.full.rotation_rad[static_cast<std::size_t>(i)] = static_cast<float>(turn.angle() * turn.axis()(i));
  p.full.position_m = {static_cast<float>(x_m), static_cast<float>(y_m), static_cast<float>(z_m)};
  return p;
}

std::vector<FloorPoint> seen_by(const CameraParameters& parameters, const std::vector<FieldPoint>& places) {
  CameraModel camera;
  EXPECT_TRUE(camera.configure(parameters).ok());
  std::vector<FloorPoint> points;
  for (const FieldPoint& p : places) {
    const PixelPoint pixel = camera.to_pixel(p, 0.0f);
    points.push_back({static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(pixel.u_px),
                      static_cast<double>(pixel.v_px)});
  }
  return points;
}

std::vector<FieldPoint> corners_of_field() { return {{-1.1f, -0.9f}, {1.1f, -0.9f}, {1.1f, 0.9f}, {-1.1f, 0.9f}}; }

std::vector<FieldPoint> marks_of_field() {
  std::vector<FieldPoint> places = corners_of_field();
  for (const float x : {-0.6f, 0.0f, 0.6f}) {
    for (const float y : {-0.9f, -0.3f, 0.3f, 0.9f}) places.push_back({x, y});
  }
  return places;
}

FieldFitInput input_of(std::vector<FloorPoint> points) { return {640, 480, std::move(points), std::nullopt}; }

TEST(FieldFit, FindsATiltedCameraFromItsFourCorners) {
  const CameraParameters truth = camera_at(0.15, -0.5, 2.1, 0.22, 430);
  FieldFit fit;
  ASSERT_EQ(fit_field(input_of(seen_by(truth, corners_of_field())), fit).text(), "");
  EXPECT_NEAR(fit.height_m, 2.1, 0.002);
  EXPECT_NEAR(static_cast<double>(fit.camera.full.fx_px), 430, 0.5);
  EXPECT_NEAR(static_cast<double>(fit.camera.full.position_m[0]), 0.15, 0.002);
  EXPECT_NEAR(static_cast<double>(fit.camera.full.position_m[1]), -0.5, 0.002);
  EXPECT_NEAR(fit.tilt_rad, 0.22, 0.001);
  EXPECT_LT(fit.residual_px.max, 0.01);
  EXPECT_LT(fit.residual_mm.max, 0.05);
  EXPECT_FALSE(fit.has_distortion);
}

TEST(FieldFit, FindsDistortionFromMorePoints) {
  const CameraParameters truth = camera_at(0.1, -0.3, 2.0, 0.18, 430, -0.12);
  FieldFit fit;
  ASSERT_EQ(fit_field(input_of(seen_by(truth, marks_of_field())), fit).text(), "");
  EXPECT_TRUE(fit.has_distortion);
  EXPECT_NEAR(static_cast<double>(fit.camera.full.k1), -0.12, 0.003);
  EXPECT_NEAR(fit.height_m, 2.0, 0.01);
  EXPECT_LT(fit.residual_px.max, 0.1);
  // Klancar's model with one parameter approximates a lens of this distortion to a few millimeters.
  EXPECT_GT(fit.paper_residual_mm.rms, 0.02);
  EXPECT_LT(fit.paper_residual_mm.rms, 4.0);
}

TEST(FieldFit, FindsPixelsThatAreNotSquare) {
  CameraParameters truth = camera_at(0.05, -0.1, 2.3, 0.03, 430, -0.05);
  truth.full.fy_px = 1.13f * truth.full.fx_px;
  FieldFitInput input = input_of(seen_by(truth, marks_of_field()));
  input.camera_height_m = 2.3;
  FieldFit fit;
  ASSERT_EQ(fit_field(input, fit).text(), "");
  EXPECT_NEAR(static_cast<double>(fit.camera.full.fy_px / fit.camera.full.fx_px), 1.13, 0.002);
  EXPECT_NEAR(fit.height_m, 2.3, 0.01);
  EXPECT_LT(fit.residual_px.max, 0.2);
}

TEST(FieldFit, EstimatesTheUncertaintyOfTheHeight) {
  const CameraParameters truth = camera_at(0.1, -0.5, 2.0, 0.22, 430);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, kClickSigma_px);
  double sum = 0, predicted = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<FloorPoint> points = seen_by(truth, corners_of_field());
    for (FloorPoint& p : points) {
      p.u_px += noise(random);
      p.v_px += noise(random);
    }
    FieldFit fit;
    ASSERT_EQ(fit_field(input_of(points), fit).text(), "");
    sum += (fit.height_m - 2.0) * (fit.height_m - 2.0);
    predicted += fit.height_sigma_m / kRounds;
  }
  const double actual = std::sqrt(sum / kRounds);
  EXPECT_GT(predicted / actual, 0.7);
  EXPECT_LT(predicted / actual, 1.4);
}

TEST(FieldFit, AVerticalCameraNeedsItsHeight) {
  const CameraParameters truth = camera_at(0.05, -0.04, 1.9, 0.01, 400);
  FieldFitInput input = input_of(seen_by(truth, corners_of_field()));
  FieldFit fit;
  Result<void> result;
  EXPECT_EQ((result = fit_field(input, fit)).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("--camera-height"), std::string::npos) << result.text();
  input.camera_height_m = 1.9;
  ASSERT_EQ(fit_field(input, fit).text(), "");
  EXPECT_NEAR(fit.height_m, 1.9, 0.005);
  EXPECT_NEAR(static_cast<double>(fit.camera.full.fx_px), 400, 2);
  EXPECT_NEAR(fit.height_sigma_m, kHeightSigma_m, 0.004);
}

// Errors of a person who takes another corner, such as that of the goal area, for the field's.
TEST(FieldFit, AWrongCornerIsNotTakenForACameraFarAway) {
  const CameraParameters truth = camera_at(0.05, -0.04, 2.0, 0.05, 500);
  int refused = 0, accepted = 0;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    for (int direction = 0; direction < 8; ++direction) {
      std::vector<FloorPoint> points = seen_by(truth, corners_of_field());
      points[corner].u_px += 25 * std::cos(direction * std::numbers::pi / 4);
      points[corner].v_px += 25 * std::sin(direction * std::numbers::pi / 4);
      FieldFit fit;
      const Result<void> result = fit_field(input_of(points), fit);
      if (result.ok()) {
        ++accepted;
        EXPECT_LT(fit.camera.full.fx_px, 2.3f * 640) << "the lens of this camera has 500 px";
        EXPECT_LT(fit.residual_px.rms, 7 * kClickSigma_px) << "corner " << corner << ", direction " << direction;
      } else {
        ++refused;
        EXPECT_NE(result.text().find("--camera-height"), std::string::npos) << result.text();
      }
    }
  }
  EXPECT_GT(refused, 20) << accepted;
}

TEST(FieldFit, BothModelsAgreeForALensWithoutDistortion) {
  const CameraParameters truth = camera_at(0.15, -0.5, 2.1, 0.22, 430);
  FieldFit fit;
  ASSERT_EQ(fit_field(input_of(seen_by(truth, corners_of_field())), fit).text(), "");
  CameraParameters paper = fit.camera;
  paper.kind = CameraModelKind::kPaper;
  CameraModel model, camera;
  ASSERT_TRUE(model.configure(paper).ok());
  ASSERT_TRUE(camera.configure(truth).ok());
  for (const FieldPoint& p : marks_of_field()) {
    for (const float height : {0.0f, 0.075f}) {
      const FieldPoint there = model.to_field(camera.to_pixel(p, height), height);
      EXPECT_NEAR(static_cast<double>(there.x_m), static_cast<double>(p.x_m), 3e-4);
      EXPECT_NEAR(static_cast<double>(there.y_m), static_cast<double>(p.y_m), 3e-4);
    }
  }
}

TEST(FieldFit, FindsTheParametersOfThePapersOwnModel) {
  CameraParameters truth;
  truth.kind = CameraModelKind::kPaper;
  truth.paper.center_u_px = 319.5f;
  truth.paper.center_v_px = 239.5f;
  truth.paper.focal_px = 700;
  truth.paper.p_per_px = 1e-4f;
  truth.paper.q_per_px = -2e-4f;
  truth.paper.affine = {0.0042f, 1e-4f, 0.02f, 2e-4f, -0.0043f, -0.03f};
  truth.paper.position_m = {0.0f, 0.0f, 2.0f};
  FieldFitInput input = input_of(seen_by(truth, marks_of_field()));
  input.camera_height_m = 2.0;
  FieldFit fit;
  ASSERT_EQ(fit_field(input, fit).text(), "");
  EXPECT_NEAR(static_cast<double>(fit.camera.paper.focal_px), 700, 7);
  EXPECT_NEAR(static_cast<double>(fit.camera.paper.p_per_px), 1e-4, 2e-6);
  EXPECT_NEAR(static_cast<double>(fit.camera.paper.q_per_px), -2e-4, 2e-6);
  EXPECT_LT(fit.paper_residual_mm.max, 0.05);
}

TEST(FieldFit, RejectsPointsThatNoCameraCanSee) {
  const CameraParameters truth = camera_at(0.15, -0.5, 2.1, 0.22, 430);
  const std::vector<FloorPoint> good = seen_by(truth, corners_of_field());
  FieldFit fit;
  Result<void> result;
  std::vector<FloorPoint> mirrored = good;
  for (FloorPoint& p : mirrored) p.u_px = 639 - p.u_px;
  EXPECT_EQ((result = fit_field(input_of(mirrored), fit)).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("mirrored"), std::string::npos) << result.text();

  // The corners are rotated by 90 degrees, so length and width are exchanged.
  std::vector<FloorPoint> turned = good;
  for (std::size_t i = 0; i < 4; ++i) {
    turned[i].u_px = good[(i + 1) % 4].u_px;
    turned[i].v_px = good[(i + 1) % 4].v_px;
  }
  EXPECT_EQ((result = fit_field(input_of(turned), fit)).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("exchanged"), std::string::npos) << result.text();

  std::vector<FloorPoint> three(good.begin(), good.begin() + 3);
  EXPECT_EQ((result = fit_field(input_of(three), fit)).code(), ErrorCode::kOutOfRange);
  std::vector<FloorPoint> doubled = good;
  doubled[3] = doubled[2];
  EXPECT_EQ((result = fit_field(input_of(doubled), fit)).code(), ErrorCode::kInconsistent);
}

TEST(Corners, AreCheckedForPlausibility) {
  const Corners good = {{{60, 440}, {580, 460}, {570, 40}, {80, 35}}};
  Result<void> result;
  EXPECT_EQ(check_corners(good).text(), "");
  // All cameras above the field keep the order, whatever their rotation.
  EXPECT_EQ(check_corners({good[2], good[3], good[0], good[1]}).text(), "");
  EXPECT_EQ((result = check_corners({good[3], good[2], good[1], good[0]})).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("clockwise"), std::string::npos) << result.text();
  EXPECT_EQ((result = check_corners({good[0], good[2], good[1], good[3]})).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("cross"), std::string::npos) << result.text();
  EXPECT_EQ((result = check_corners({{{60, 440}, {320, 450.3f}, {580, 460}, {80, 35}}})).code(),
            ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("one line"), std::string::npos) << result.text();
  EXPECT_EQ((result = check_corners({{{60, 440}, {580, 460}, {250, 300}, {80, 35}}})).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("inside"), std::string::npos) << result.text();
  EXPECT_EQ((result = check_corners({good[0], good[1], good[1], good[3]})).code(), ErrorCode::kInconsistent);
}

TEST(Corners, HaveThePositionsOfTheFieldsCorners) {
  const Corners corners = {{{60, 440}, {580, 460}, {570, 40}, {80, 35}}};
  const std::vector<FloorPoint> points = corner_points(corners, kLength_m, kWidth_m);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_DOUBLE_EQ(points[1].x_m, 1.1);
  EXPECT_DOUBLE_EQ(points[1].y_m, -0.9);
  EXPECT_DOUBLE_EQ(points[3].x_m, -1.1);
  EXPECT_DOUBLE_EQ(points[3].y_m, 0.9);
}

}  // namespace
}  // namespace touchline::calibrate
