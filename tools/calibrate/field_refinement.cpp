#include "tools/calibrate/field_refinement.h"

#include <ceres/rotation.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/calibrate/least_squares.h"
#include "tools/calibrate/paper_fit.h"
#include "tools/calibrate/text.h"

namespace touchline::calibrate {
namespace {

// One point of a mark across a picture's pixels; closer ones see the same pixels.
constexpr double kStep_px = 3.0;
// Reach of the search, and the scale of the loss, round by round. Four corners without distortion leave the sides'
// middles two dozen pixels off under a wide lens; the last rounds settle.
struct Round {
  double reach_px, loss_px;
  int lens;  // how much of the lens is free: 1 k1; 2 k1, k2 and the principal point; 3 all
};
constexpr std::array<Round, 7> kRounds{
    {{30, 4, 1}, {16, 2, 2}, {10, 1, 2}, {8, 0.5, 3}, {8, 0.3, 3}, {8, 0.3, 3}, {8, 0.3, 3}}};
// What a blurred edge's place is good for.
constexpr double kEdgeSigma_px = 0.15;
// Beyond this a point belongs to something else than the mark.
constexpr double kOutlier_px = 1.0;
// A side counts as found when so much of the points along it were.
constexpr double kLeastShare = 0.4;
// Lenses are mounted within some percent of the picture's width; makers of sensors promise square pixels.
constexpr double kCenterSigma_px = 25.0;
constexpr double kAspectSigma = 0.002;
// Typical sizes of the terms: what the border cannot tell stays near zero.
constexpr std::array<double, 5> kLensSigma{0.5, 0.3, 0.1, 0.003, 0.003};

enum Intrinsic : std::size_t { kFocal, kAspect, kCenterU, kCenterV, kK1, kK2, kK3, kP1, kP2, kIntrinsics };

struct Camera {
  std::array<double, kIntrinsics> intrinsics{};
  std::array<double, 3> rotation{}, position_m{};
};

// Distance across the mark; the lens as core/geometry has it.
struct AcrossMark {
  MarkPoint point;
  template <class T>
  bool operator()(const T* lens, const T* rotation, const T* position, T* residual) const {
    const T offset[3] = {point.x_m - position[0], point.y_m - position[1], -position[2]};
    T camera[3];
    ceres::AngleAxisRotatePoint(rotation, offset, camera);
    if (camera[2] <= T(0)) return false;
    const T x = camera[0] / camera[2], y = camera[1] / camera[2], r2 = x * x + y * y;
    const T radial = T(1) + r2 * (lens[kK1] + r2 * (lens[kK2] + r2 * lens[kK3]));
    const T bent_x = x * radial + T(2) * lens[kP1] * x * y + lens[kP2] * (r2 + T(2) * x * x);
    const T bent_y = y * radial + lens[kP1] * (r2 + T(2) * y * y) + T(2) * lens[kP2] * x * y;
    const T u = lens[kFocal] * bent_x + lens[kCenterU];
    const T v = lens[kFocal] * lens[kAspect] * bent_y + lens[kCenterV];
    residual[0] = ((u - point.u_px) * point.across_u + (v - point.v_px) * point.across_v) / kEdgeSigma_px;
    return true;
  }
};

Camera camera_of(const FullModelParameters& full) {
  Camera camera;
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

FullModelParameters full_of(const Camera& camera) {
  const auto& lens = camera.intrinsics;
  FullModelParameters full;
  const auto as_float = [](double value) { return static_cast<float>(value); };
  full.fx_px = as_float(lens[kFocal]);
  full.fy_px = as_float(lens[kFocal] * lens[kAspect]);
  full.cx_px = as_float(lens[kCenterU]);
  full.cy_px = as_float(lens[kCenterV]);
  full.k1 = as_float(lens[kK1]);
  full.k2 = as_float(lens[kK2]);
  full.k3 = as_float(lens[kK3]);
  full.p1 = as_float(lens[kP1]);
  full.p2 = as_float(lens[kP2]);
  std::transform(camera.rotation.begin(), camera.rotation.end(), full.rotation_rad.begin(), as_float);
  std::transform(camera.position_m.begin(), camera.position_m.end(), full.position_m.begin(), as_float);
  return full;
}

class Adjustment {
 public:
  Adjustment(const LightPicture& picture, const std::optional<double>& height_m, const Camera& start)
      : center_u_(0.5 * (picture.width_px() - 1)),
        center_v_(0.5 * (picture.height_px() - 1)),
        height_m_(height_m),
        aspect_(start.intrinsics[kAspect]) {}

  bool run(const std::vector<MarkPoint>& points, const Round& round, Camera& camera, double* height_sigma_m) const {
    ceres::Problem problem;
    for (const MarkPoint& point : points) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<AcrossMark, 1, kIntrinsics, 3, 3>(new AcrossMark{point}),
                               new ceres::CauchyLoss(round.loss_px / kEdgeSigma_px), camera.intrinsics.data(),
                               camera.rotation.data(), camera.position_m.data());
    }
    const auto expect = [&](std::size_t index, double value, double sigma) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 1, kIntrinsics>(new Prior{index, value, sigma}),
                               nullptr, camera.intrinsics.data());
    };
    expect(kAspect, aspect_, kAspectSigma);
    expect(kCenterU, center_u_, kCenterSigma_px);
    expect(kCenterV, center_v_, kCenterSigma_px);
    for (std::size_t i = 0; i < kLensSigma.size(); ++i) expect(kK1 + i, 0.0, kLensSigma[i]);
    if (height_m_) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 1, 3>(new Prior{2, *height_m_, kHeightSigma_m}),
                               nullptr, camera.position_m.data());
    }
    std::vector<int> fixed;
    if (round.lens < 3) fixed.insert(fixed.end(), {kAspect, kK3, kP1, kP2});
    if (round.lens < 2) fixed.insert(fixed.end(), {kCenterU, kCenterV, kK2});
    if (!fixed.empty()) {
      problem.SetManifold(camera.intrinsics.data(), new ceres::SubsetManifold(kIntrinsics, fixed));
    }
    const ceres::Solver::Summary summary = minimize(problem, 1e-10);
    if (!summary.IsSolutionUsable() || camera.position_m[2] <= 0 || camera.intrinsics[kFocal] <= 0) return false;
    if (height_sigma_m != nullptr) *height_sigma_m = height_sigma(problem, camera);
    return true;
  }

 private:
  static double height_sigma(ceres::Problem& problem, const Camera& camera) {
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::DENSE_SVD;
    options.null_space_rank = -1;
    ceres::Covariance covariance(options);
    const double* position = camera.position_m.data();
    std::array<double, 9> block{};
    const std::vector<std::pair<const double*, const double*>> wanted{{position, position}};
    if (!covariance.Compute(wanted, &problem) || !covariance.GetCovarianceBlock(position, position, block.data())) {
      return std::numeric_limits<double>::infinity();
    }
    return std::sqrt(block[8]);
  }

  double center_u_, center_v_;
  std::optional<double> height_m_;
  double aspect_;
};

// Which of the border's sides were found over enough of their length.
std::size_t sides_found(const std::vector<MarkPoint>& points, const std::vector<Mark>& marks,
                        const CameraModel& camera) {
  std::size_t sides = 0;
  for (std::size_t m = 0; m < marks.size(); ++m) {
    if (marks[m].kind != MarkKind::kBorder) continue;
    const PixelPoint begin =
        camera.to_pixel({static_cast<float>(marks[m].begin_x_m), static_cast<float>(marks[m].begin_y_m)}, 0.0f);
    const PixelPoint end =
        camera.to_pixel({static_cast<float>(marks[m].end_x_m), static_cast<float>(marks[m].end_y_m)}, 0.0f);
    const double extent =
        std::hypot(static_cast<double>(end.u_px - begin.u_px), static_cast<double>(end.v_px - begin.v_px));
    const auto count = std::count_if(points.begin(), points.end(), [&](const MarkPoint& p) { return p.mark == m; });
    sides += static_cast<double>(count) * kStep_px > kLeastShare * extent ? 1u : 0u;
  }
  return sides;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

// Distance of a found point from where the model has its mark: across it, in the picture and on the floor.
void add_residuals(const CameraModel& camera, RefinementReport& report) {
  std::vector<double> pixels, millimeters;
  std::vector<MarkPoint> kept;
  for (const MarkPoint& p : report.found) {
    const PixelPoint at = camera.to_pixel({static_cast<float>(p.x_m), static_cast<float>(p.y_m)}, 0.0f);
    const double off = std::abs((static_cast<double>(at.u_px) - p.u_px) * p.across_u +
                                (static_cast<double>(at.v_px) - p.v_px) * p.across_v);
    if (off > kOutlier_px) {
      ++report.outliers;
      continue;
    }
    const double scale =
        static_cast<double>(camera.scale_px_per_m({static_cast<float>(p.x_m), static_cast<float>(p.y_m)}, 0.0f));
    pixels.push_back(off);
    millimeters.push_back(1e3 * off / scale);
    kept.push_back(p);
  }
  report.found = std::move(kept);
  report.points = pixels.size();
  report.rms_px = rms(pixels);
  report.p95_px = percentile(pixels, 0.95);
  report.max_px = percentile(pixels, 1.0);
  report.rms_mm = rms(millimeters);
  report.p95_mm = percentile(millimeters, 0.95);
  report.max_mm = percentile(millimeters, 1.0);
}

}  // namespace

Status refine_field(const LightPicture& picture, const FieldParameters& field,
                    const std::optional<double>& camera_height_m, FieldFit& fit, RefinementReport& report,
                    std::string& reason) {
  report = {};
  const std::vector<Mark> marks = marks_of(field);
  Camera camera = camera_of(fit.camera.full);
  const Adjustment adjustment(picture, camera_height_m, camera);
  CameraParameters parameters = fit.camera;
  CameraModel model;
  for (std::size_t i = 0; i <= kRounds.size(); ++i) {
    if (!model.configure(parameters).ok()) {
      reason = "the border leads to no camera that makes sense";
      return ErrorCode::kNotFound;
    }
    const bool last = i == kRounds.size();
    const Round& round = kRounds[last ? i - 1 : i];
    report.found = find_marks(picture, model, marks, kStep_px, round.reach_px);
    const std::size_t sides = sides_found(report.found, marks, model);
    if (sides < kLeastSides) {
      reason = text("only %zu of the border's four sides can be found where the points given would have them", sides);
      return ErrorCode::kNotFound;
    }
    if (last) break;
    if (!adjustment.run(report.found, round, camera, i + 1 == kRounds.size() ? &report.height_sigma_m : nullptr)) {
      reason = "the border and the points given contradict each other";
      return ErrorCode::kNotFound;
    }
    parameters.full = full_of(camera);
  }
  add_residuals(model, report);
  if (report.outliers > report.points) {
    reason = text("%zu of %zu points found along the border do not lie on one field's outline", report.outliers,
                  report.points + report.outliers);
    return ErrorCode::kNotFound;
  }
  FieldFit refined = fit;
  refined.camera.full = parameters.full;
  refined.has_distortion = true;
  refined.height_m = camera.position_m[2];
  refined.height_sigma_m = report.height_sigma_m;
  const Eigen::Vector3d turn(camera.rotation.data());
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  refined.tilt_rad = std::acos(std::clamp(-rotation(2, 2), -1.0, 1.0));
  FieldFitInput input;
  input.width_px = picture.width_px();
  input.height_px = picture.height_px();
  for (const MarkPoint& p : report.found) input.points.push_back({p.x_m, p.y_m, p.u_px, p.v_px});
  refined.paper_residual_mm = {};
  if (!fit_paper_model(input, refined, reason).ok()) return ErrorCode::kNotFound;
  fit = refined;
  return {};
}

}  // namespace touchline::calibrate
