#include "tools/programs/calibrate/field/camera_adjustment.h"

#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/programs/calibrate/field/least_squares.h"

namespace touchline::calibrate {
namespace {

// Standard deviations of the priors: the principal point lies within a few percent of the picture width from the
// center; sensors have square pixels.
constexpr double kCenterSigma = 0.04;
constexpr double kSensorAspectSigma = 0.002;
// Prior of the pixel aspect ratio. If the start differs from square pixels by more than kSquare, the driver has
// stretched the picture. Clicked points then determine the aspect ratio to one percent (two pixels in two hundred).
constexpr double kStretchedAspectSigma = 0.01, kSquare = 0.01;
// Typical sizes of the distortion terms: terms that the border does not determine stay near zero.
constexpr std::array<double, 5> kLensSigma{0.5, 0.3, 0.1, 0.003, 0.003};
constexpr Eigen::Index kUnknowns = kIntrinsics + 6;

// Projects a point with the lens model of core/geometry. Returns false if it is behind the camera.
template <class T>
bool project(const T* lens, const T* rotation, const T* position, const std::array<double, 3>& place, T* pixel) {
  const T offset[3] = {place[0] - position[0], place[1] - position[1], place[2] - position[2]};
  T camera[3];
  ceres::AngleAxisRotatePoint(rotation, offset, camera);
  if (camera[2] <= T(0)) return false;
  const T x = camera[0] / camera[2], y = camera[1] / camera[2], r2 = x * x + y * y;
  const T radial = T(1) + r2 * (lens[kK1] + r2 * (lens[kK2] + r2 * lens[kK3]));
  const T bent_x = x * radial + T(2) * lens[kP1] * x * y + lens[kP2] * (r2 + T(2) * x * x);
  const T bent_y = y * radial + lens[kP1] * (r2 + T(2) * y * y) + T(2) * lens[kP2] * x * y;
  pixel[0] = lens[kFocal] * bent_x + lens[kCenterU];
  pixel[1] = lens[kFocal] * lens[kAspect] * bent_y + lens[kCenterV];
  return true;
}

// Residual of a mark's point: its distance perpendicular to the mark.
struct AcrossMark {
  MarkPoint point;
  double sigma_px;
  template <class T>
  bool operator()(const T* lens, const T* rotation, const T* position, T* residual) const {
    T pixel[2];
    if (!project(lens, rotation, position, {point.x_m, point.y_m, 0.0}, pixel)) return false;
    residual[0] = ((pixel[0] - point.u_px) * point.across_u + (pixel[1] - point.v_px) * point.across_v) / sigma_px;
    return true;
  }
};

using UnknownsVector = Eigen::Matrix<double, kUnknowns, 1>;

UnknownsVector unknowns_of(const AdjustedCamera& camera) {
  UnknownsVector x;
  for (std::size_t i = 0; i < kIntrinsics; ++i) x(static_cast<Eigen::Index>(i)) = camera.intrinsics[i];
  for (std::size_t i = 0; i < 3; ++i) {
    x(static_cast<Eigen::Index>(kIntrinsics + i)) = camera.rotation[i];
    x(static_cast<Eigen::Index>(kIntrinsics + 3 + i)) = camera.position_m[i];
  }
  return x;
}

Eigen::Vector2d seen(const UnknownsVector& x, const std::array<double, 3>& place) {
  Eigen::Vector2d pixel(0, 0);
  static_cast<void>(project(x.data(), x.data() + kIntrinsics, x.data() + kIntrinsics + 3, place, pixel.data()));
  return pixel;
}

// Returns the standard deviation, in mm, of the floor position that a fixed pixel shows, caused by the uncertainty of
// the camera.
double place_sigma_mm(const UnknownsVector& x, const Eigen::MatrixXd& covariance, const std::array<double, 3>& place) {
  Eigen::Matrix<double, 2, kUnknowns> by_camera;
  for (Eigen::Index i = 0; i < kUnknowns; ++i) {
    const double step = 1e-6 * std::max(1.0, std::abs(x(i)));
    UnknownsVector more = x, less = x;
    more(i) += step;
    less(i) -= step;
    by_camera.col(i) = (seen(more, place) - seen(less, place)) / (2 * step);
  }
  constexpr double kStep_m = 1e-5;
  Eigen::Matrix2d by_place;
  by_place.col(0) =
      (seen(x, {place[0] + kStep_m, place[1], place[2]}) - seen(x, {place[0] - kStep_m, place[1], place[2]})) /
      (2 * kStep_m);
  by_place.col(1) =
      (seen(x, {place[0], place[1] + kStep_m, place[2]}) - seen(x, {place[0], place[1] - kStep_m, place[2]})) /
      (2 * kStep_m);
  const Eigen::Matrix<double, 2, kUnknowns> off = by_place.inverse() * by_camera;
  return 1e3 * std::sqrt((off * covariance * off.transpose()).trace());
}

}  // namespace

AdjustedCamera AdjustedCamera::of(const FullModelParameters& full) {
  AdjustedCamera camera;
  const auto as_double = [](float value) { return static_cast<double>(value); };
  camera.intrinsics = {as_double(full.fx_px), as_double(full.fy_px) / as_double(full.fx_px),
                       as_double(full.cx_px), as_double(full.cy_px),
                       as_double(full.k1),    as_double(full.k2),
                       as_double(full.k3),    as_double(full.p1),
                       as_double(full.p2)};
  std::transform(full.rotation_rad.begin(), full.rotation_rad.end(), camera.rotation.begin(), as_double);
  std::transform(full.position_m.begin(), full.position_m.end(), camera.position_m.begin(), as_double);
  return camera;
}

FullModelParameters AdjustedCamera::full() const {
  FullModelParameters full;
  const auto as_float = [](double value) { return static_cast<float>(value); };
  full.fx_px = as_float(intrinsics[kFocal]);
  full.fy_px = as_float(intrinsics[kFocal] * intrinsics[kAspect]);
  full.cx_px = as_float(intrinsics[kCenterU]);
  full.cy_px = as_float(intrinsics[kCenterV]);
  full.k1 = as_float(intrinsics[kK1]);
  full.k2 = as_float(intrinsics[kK2]);
  full.k3 = as_float(intrinsics[kK3]);
  full.p1 = as_float(intrinsics[kP1]);
  full.p2 = as_float(intrinsics[kP2]);
  std::transform(rotation.begin(), rotation.end(), full.rotation_rad.begin(), as_float);
  std::transform(position_m.begin(), position_m.end(), full.position_m.begin(), as_float);
  return full;
}

Adjustment::Adjustment(int width_px, int height_px, const std::optional<HeightPrior>& height,
                       const AdjustedCamera& start)
    : width_px_(width_px),
      center_u_(0.5 * (width_px - 1)),
      center_v_(0.5 * (height_px - 1)),
      aspect_(start.intrinsics[kAspect]),
      height_(height) {}

namespace {

void expect(ceres::Problem& problem, AdjustedCamera& camera, std::size_t index, double value, double sigma) {
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 1, kIntrinsics>(new Prior{index, value, sigma}),
                           nullptr, camera.intrinsics.data());
}

}  // namespace

Adjustment Adjustment::of_any_focal_length(const std::optional<HeightPrior>& height) const {
  Adjustment other = *this;
  other.height_ = height;
  other.usual_focal_length_ = false;
  return other;
}

void Adjustment::add_lens_knowledge(ceres::Problem& problem, AdjustedCamera& camera) const {
  expect(problem, camera, kAspect, aspect_,
         std::abs(aspect_ - 1) > kSquare ? kStretchedAspectSigma : kSensorAspectSigma);
  expect(problem, camera, kCenterU, center_u_, kCenterSigma * width_px_);
  expect(problem, camera, kCenterV, center_v_, kCenterSigma * width_px_);
  for (std::size_t i = 0; i < kLensSigma.size(); ++i) expect(problem, camera, kK1 + i, 0.0, kLensSigma[i]);
  if (!usual_focal_length_) return;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<LogPrior, 1, kIntrinsics>(
                               new LogPrior{kFocal, kFocalWidths * width_px_, kFocalSigma}),
                           nullptr, camera.intrinsics.data());
}

void Adjustment::build(ceres::Problem& problem, const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                       AdjustedCamera& camera) const {
  for (const MarkPoint& point : points) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<AcrossMark, 1, kIntrinsics, 3, 3>(new AcrossMark{point, weights.edge_sigma_px}),
        new ceres::CauchyLoss(weights.loss_px / weights.edge_sigma_px), camera.intrinsics.data(),
        camera.rotation.data(), camera.position_m.data());
  }
  add_lens_knowledge(problem, camera);
  if (height_) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Prior, 1, 3>(new Prior{2, height_->height_m, height_->sigma_m}), nullptr,
        camera.position_m.data());
  }
}

double Adjustment::chi_square(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                              AdjustedCamera camera) const {
  ceres::Problem problem;
  build(problem, points, weights, camera);
  double half = 0;
  return problem.Evaluate({}, &half, nullptr, nullptr, nullptr) ? 2 * half : std::numeric_limits<double>::infinity();
}

bool Adjustment::run(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                     AdjustedCamera& camera) const {
  ceres::Problem problem;
  build(problem, points, weights, camera);
  std::vector<int> fixed;
  if (weights.lens < 3) fixed.insert(fixed.end(), {kAspect, kK3, kP1, kP2});
  if (weights.lens < 2) fixed.insert(fixed.end(), {kCenterU, kCenterV, kK2});
  if (!fixed.empty()) {
    problem.SetManifold(camera.intrinsics.data(), new ceres::SubsetManifold(kIntrinsics, fixed));
  }
  const ceres::Solver::Summary summary = minimize(problem, 1e-10);
  return summary.IsSolutionUsable() && camera.position_m[2] > 0 && camera.intrinsics[kFocal] > 0;
}

CameraUncertainty Adjustment::uncertainty(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                                          AdjustedCamera camera, const FieldParameters& field) const {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  CameraUncertainty out{kNothing, kNothing, kNothing, kNothing, kNothing, kNothing,
                        kNothing, kNothing, kNothing, kNothing, kNothing};
  ceres::Problem lens;
  add_lens_knowledge(lens, camera);
  double half_squares = 0;
  if (!lens.Evaluate({}, &half_squares, nullptr, nullptr, nullptr)) return out;
  out.lens_chi_square = 2 * half_squares;
  ceres::Problem problem;
  build(problem, points, weights, camera);
  const std::optional<Eigen::MatrixXd> inverse = covariance_of(problem);
  if (!inverse || inverse->rows() != kUnknowns) return out;
  const Eigen::MatrixXd& covariance = *inverse;
  const UnknownsVector x = unknowns_of(camera);
  const auto sigma = [&](std::size_t index) {
    const auto i = static_cast<Eigen::Index>(index);
    return std::sqrt(std::max(0.0, covariance(i, i)));
  };
  out.focal_px = sigma(kFocal);
  out.center_u_px = sigma(kCenterU);
  out.center_v_px = sigma(kCenterV);
  out.x_m = sigma(kIntrinsics + 3);
  out.y_m = sigma(kIntrinsics + 4);
  out.height_m = sigma(kIntrinsics + 5);
  // Angle between the optical axis and the vertical.
  Eigen::Matrix<double, 1, kUnknowns> by_rotation = Eigen::Matrix<double, 1, kUnknowns>::Zero();
  const auto tilt = [](const UnknownsVector& at) {
    const double* rotation = at.data() + kIntrinsics;
    const double down[3] = {0, 0, -1};
    double axis[3];
    ceres::AngleAxisRotatePoint(rotation, down, axis);
    return std::acos(std::clamp(axis[2], -1.0, 1.0));
  };
  for (Eigen::Index i = kUnknowns - 6; i < kUnknowns - 3; ++i) {
    constexpr double kStep = 1e-5;
    UnknownsVector more = x, less = x;
    more(i) += kStep;
    less(i) -= kStep;
    by_rotation(i) = (tilt(more) - tilt(less)) / (2 * kStep);
  }
  out.tilt_rad = std::sqrt((by_rotation * covariance * by_rotation.transpose())(0, 0));
  out.floor_center_mm = place_sigma_mm(x, covariance, {0, 0, 0});
  out.floor_corner_mm = out.top_corner_mm = 0;
  const double half_length = static_cast<double>(field.length_m) / 2,
               half_width = static_cast<double>(field.width_m) / 2;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const double at_x = sx * half_length, at_y = sy * half_width;
      out.floor_corner_mm = std::max(out.floor_corner_mm, place_sigma_mm(x, covariance, {at_x, at_y, 0}));
      out.top_corner_mm = std::max(out.top_corner_mm, place_sigma_mm(x, covariance, {at_x, at_y, kTop_m}));
    }
  }
  return out;
}

}  // namespace touchline::calibrate
