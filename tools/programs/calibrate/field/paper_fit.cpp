#include "tools/programs/calibrate/field/paper_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tools/programs/calibrate/field/homography.h"
#include "tools/programs/calibrate/field/least_squares.h"

namespace touchline::calibrate {
namespace {

// Value of H for a lens without distortion: eq. (12) then moves no pixel of any frame by more than a thousandth of a
// pixel.
constexpr double kStraightLens_px = 1e5;

// Computes eq. (12) with the curvature c = 1 / H^2: R / r = sinh(r / H) / (r / H) as a series, which is smooth at c =
// 0.
template <class T>
T stretch(const T& curvature, double r2) {
  const T s = curvature * r2;
  return T(1) + s / 6.0 * (T(1) + s / 20.0 * (T(1) + s / 42.0 * (T(1) + s / 72.0)));
}

struct PaperResidual {
  FloorPoint point;
  double center_u_px, center_v_px;
  // pixels per meter, so that residuals have the same weights as clicks in pixels
  double scale;
  template <class T>
  bool operator()(const T* curvature, const T* tilt, const T* affine, T* residual) const {
    const double u = point.u_px - center_u_px, v = point.v_px - center_v_px;
    const T k = stretch(curvature[0], u * u + v * v);
    const T radial_x = k * u, radial_y = k * v;  // X, Y in the paper
    const T d = T(1) - tilt[0] * radial_x - tilt[1] * radial_y;
    const T x = radial_x / d, y = radial_y / d;
    residual[0] = scale * (affine[0] * x + affine[1] * y + affine[2] - point.x_m);
    residual[1] = scale * (affine[3] * x + affine[4] * y + affine[5] - point.y_m);
    return true;
  }
};

}  // namespace

Result<void> fit_paper_model(const FieldFitInput& input, FieldFit& fit) {
  const FullModelParameters& full = fit.camera.full;
  const double cu = static_cast<double>(full.cx_px), cv = static_cast<double>(full.cy_px);
  const double focal = static_cast<double>(full.fx_px), k1 = static_cast<double>(full.k1);
  // Start with the H at which the third order of eq. (12) equals that of Brown's model: k1 / f^2 = -1 / (6 H^2). The
  // model cannot represent pincushion distortion.
  double curvature = std::max(-6.0 * k1 / (focal * focal), 1.0 / (kStraightLens_px * kStraightLens_px));

  std::vector<FloorPoint> straight = input.points;
  for (FloorPoint& p : straight) {
    const double u = p.u_px - cu, v = p.v_px - cv, k = stretch(curvature, u * u + v * v);
    p.u_px = k * u;
    p.v_px = k * v;
  }
  const auto homography = floor_to_picture(straight, 0.0, 0.0);
  if (!homography) {
    return Error{ErrorCode::kInconsistent, "the points do not determine the model of eq. (14)"};
  }
  // The homography from the straightened picture to the floor is the affine part A, followed by the division by 1 - pX
  // - qY: its last row contains p and q.
  Eigen::Matrix3d back = homography->inverse();
  back /= back(2, 2);
  double tilt[2] = {-back(2, 0), -back(2, 1)};
  double affine[6];
  for (int row = 0; row < 2; ++row) {
    affine[3 * row + 0] = back(row, 0) + back(row, 2) * tilt[0];
    affine[3 * row + 1] = back(row, 1) + back(row, 2) * tilt[1];
    affine[3 * row + 2] = back(row, 2);
  }
  const double scale = 1.0 / std::sqrt(std::abs(affine[0] * affine[4] - affine[1] * affine[3]));

  ceres::Problem problem;
  for (const FloorPoint& p : input.points) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PaperResidual, 2, 1, 2, 6>(new PaperResidual{p, cu, cv, scale}), nullptr,
        &curvature, tilt, affine);
  }
  if (fit.has_distortion) {
    problem.SetParameterLowerBound(&curvature, 0, 1.0 / (kStraightLens_px * kStraightLens_px));
  } else {
    problem.SetParameterBlockConstant(&curvature);
  }
  minimize(problem, 1e-14);

  PaperModelParameters& paper = fit.camera.paper;
  paper.center_u_px = full.cx_px;
  paper.center_v_px = full.cy_px;
  paper.focal_px = static_cast<float>(1.0 / std::sqrt(curvature));
  paper.p_per_px = static_cast<float>(tilt[0]);
  paper.q_per_px = static_cast<float>(tilt[1]);
  for (std::size_t i = 0; i < 6; ++i) paper.affine[i] = static_cast<float>(affine[i]);
  paper.position_m = full.position_m;

  fit.paper_residual_mm = paper_residual(paper, input.points);
  return {};
}

std::array<double, 3> brown_of_eq12(double h_px, double focal_px, double radius_px) {
  constexpr Eigen::Index kSteps = 40;
  Eigen::Matrix<double, kSteps, 3> powers;
  Eigen::Matrix<double, kSteps, 1> values;
  for (Eigen::Index i = 0; i < kSteps; ++i) {
    const double seen_px = radius_px * static_cast<double>(i + 1) / kSteps;
    const double r = h_px * std::sinh(seen_px / h_px) / focal_px, r2 = r * r;
    powers.row(i) << r * r2, r * r2 * r2, r * r2 * r2 * r2;
    values(i) = seen_px / focal_px - r;
  }
  const Eigen::Vector3d k = (powers.transpose() * powers).ldlt().solve(powers.transpose() * values);
  return {k.x(), k.y(), k.z()};
}

ResidualSummary paper_residual(const PaperModelParameters& model, const std::vector<FloorPoint>& points) {
  const double h = static_cast<double>(model.focal_px), curvature = 1.0 / (h * h);
  const double tilt[2] = {static_cast<double>(model.p_per_px), static_cast<double>(model.q_per_px)};
  std::array<double, 6> affine{};
  std::copy(model.affine.begin(), model.affine.end(), affine.begin());
  ResidualSummary spread;
  for (const FloorPoint& p : points) {
    double residual[2];
    PaperResidual{p, static_cast<double>(model.center_u_px), static_cast<double>(model.center_v_px), 1e3}(
        &curvature, tilt, affine.data(), residual);
    const double mm = std::hypot(residual[0], residual[1]);
    spread.rms += mm * mm / static_cast<double>(points.size());
    spread.max = std::max(spread.max, mm);
  }
  spread.rms = std::sqrt(spread.rms);
  return spread;
}

}  // namespace touchline::calibrate
