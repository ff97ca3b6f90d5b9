#include "tools/programs/calibrate/field/field_fit.h"

#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tools/programs/calibrate/field/homography.h"
#include "tools/programs/calibrate/field/least_squares.h"
#include "tools/programs/calibrate/field/paper_fit.h"

namespace touchline::calibrate {
namespace {

// Unknowns of the full model in the order that the solver uses.
struct CameraUnknowns {
  double focal_px = 0;
  std::array<double, 3> rotation{}, position_m{};
  double k1 = 0;
  double aspect = 1;  // fy / fx
};

struct Center {
  double u_px = 0, v_px = 0;
};

// Pinhole projection with k1 as core/geometry defines it, in double precision with derivatives.
struct Reprojection {
  FloorPoint point;
  Center center;
  template <class T>
  bool operator()(const T* focal, const T* rotation, const T* position, const T* k1, const T* aspect,
                  T* residual) const {
    const T offset[3] = {point.x_m - position[0], point.y_m - position[1], -position[2]};
    T camera[3];
    ceres::AngleAxisRotatePoint(rotation, offset, camera);
    if (camera[2] <= T(0)) return false;
    const T x = camera[0] / camera[2], y = camera[1] / camera[2];
    const T stretch = focal[0] * (T(1) + k1[0] * (x * x + y * y));
    residual[0] = stretch * x + center.u_px - point.u_px;
    residual[1] = stretch * aspect[0] * y + center.v_px - point.v_px;
    return true;
  }
};

// Standard deviation of the prior of k1. Lenses of the leagues have a few tenths; the prior keeps k1 finite if the
// points hardly determine it.
constexpr double kDistortionSigma = 0.5;

// Standard deviation of the prior of the pixel aspect ratio. Drivers that scale a wide picture to 4:3 stretch it by up
// to a third; most do not scale.
constexpr double kScaledAspectSigma = 0.1;

class Solver {
 public:
  Solver(const FieldFitInput& input, Center center) : input_(input), center_(center) {}

  // Returns half the sum of squares, or infinity if the start is unusable. Distortion is freed last, because it
  // diverges if the focal length is still wrong.
  double refine(CameraUnknowns& x) const {
    const double straight = minimize(x, false);
    if (!has_distortion() || !std::isfinite(straight)) return straight;
    CameraUnknowns curved = x;
    const double cost = minimize(curved, true);
    if (cost < straight) x = curved;
    return std::min(cost, straight);
  }

  [[nodiscard]] bool has_distortion() const { return input_.points.size() >= kPointsForDistortion; }

  // Returns whether the aspect ratio is estimated: four points and a height give nine equations for eight unknowns.
  [[nodiscard]] bool has_free_aspect() const {
    return (has_distortion() || input_.free_aspect) && input_.camera_height_m.has_value();
  }

  // Returns the standard deviation of the camera height for clicks with kClickSigma_px; infinity if the height is not
  // determined.
  double height_sigma_m(CameraUnknowns& x) const {
    ceres::Problem problem;
    build(problem, x, has_distortion());
    // Order: focal length, rotation, position, and k1 and aspect ratio if they are free.
    constexpr Eigen::Index kHeight = 6;
    const std::optional<Eigen::MatrixXd> covariance = covariance_of(problem);
    return covariance ? std::sqrt((*covariance)(kHeight, kHeight)) : std::numeric_limits<double>::infinity();
  }

  // Returns the factor by which the errors of the points exceed kClickSigma_px without a given height; at least 1. The
  // prior on the accuracy of clicks counts as kPrior additional equations, because four points give only one equation
  // more than there are unknowns. `misfit_px`: root mean square distance.
  [[nodiscard]] double deviation_scale(double misfit_px) const {
    constexpr double kPrior = 4;
    const auto points = static_cast<double>(input_.points.size());
    const double unknowns = has_distortion() ? 8 : 7;  // focal length, rotation, position, k1
    const double ratio = misfit_px / kClickSigma_px;
    return std::sqrt(std::max(1.0, (kPrior + points * ratio * ratio) / (kPrior + 2 * points - unknowns)));
  }

 private:
  double minimize(CameraUnknowns& x, bool with_distortion) const {
    ceres::Problem problem;
    build(problem, x, with_distortion);
    const ceres::Solver::Summary summary = calibrate::minimize(problem, 1e-12, 1e-12);
    return summary.IsSolutionUsable() && x.position_m[2] > 0 ? summary.final_cost
                                                             : std::numeric_limits<double>::infinity();
  }

  void build(ceres::Problem& problem, CameraUnknowns& x, bool with_distortion) const {
    for (const FloorPoint& p : input_.points) {
      // Divides pixels by the standard deviation of a click, so that the priors have the right weight.
      auto* loss = new ceres::ScaledLoss(nullptr, 1.0 / (kClickSigma_px * kClickSigma_px), ceres::TAKE_OWNERSHIP);
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Reprojection, 2, 1, 3, 3, 1, 1>(new Reprojection{p, center_}), loss,
          &x.focal_px, x.rotation.data(), x.position_m.data(), &x.k1, &x.aspect);
    }
    if (input_.camera_height_m) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Prior, 1, 3>(new Prior{2, *input_.camera_height_m, kHeightSigma_m}), nullptr,
          x.position_m.data());
    }
    if (input_.start_only) {
      // Without a prior, the optimizer could start a vertical camera at any height.
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<LogPrior, 1, 1>(new LogPrior{0, kFocalWidths * input_.width_px, kFocalSigma}),
          nullptr, &x.focal_px);
    }
    // While the height is free, non-square pixels have the same effect as a tilt.
    if (!has_free_aspect()) {
      problem.SetParameterBlockConstant(&x.aspect);
    } else {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 1, 1>(new Prior{0, 1.0, kScaledAspectSigma}),
                               nullptr, &x.aspect);
    }
    if (!with_distortion) {
      problem.SetParameterBlockConstant(&x.k1);
    } else {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 1, 1>(new Prior{0, 0.0, kDistortionSigma}),
                               nullptr, &x.k1);
    }
  }

  const FieldFitInput& input_;
  Center center_;
};

FullModelParameters full_model(const CameraUnknowns& x, Center center) {
  FullModelParameters full;
  full.fx_px = static_cast<float>(x.focal_px);
  full.fy_px = static_cast<float>(x.focal_px * x.aspect);
  full.cx_px = static_cast<float>(center.u_px);
  full.cy_px = static_cast<float>(center.v_px);
  full.k1 = static_cast<float>(x.k1);
  for (std::size_t i = 0; i < 3; ++i) {
    full.rotation_rad[i] = static_cast<float>(x.rotation[i]);
    full.position_m[i] = static_cast<float>(x.position_m[i]);
  }
  return full;
}

void add_residuals(const FieldFitInput& input, const CameraModel& camera, FieldFit& out) {
  for (const FloorPoint& p : input.points) {
    const PixelPoint seen = camera.to_pixel({static_cast<float>(p.x_m), static_cast<float>(p.y_m)}, 0.0f);
    const FieldPoint there = camera.to_field({static_cast<float>(p.u_px), static_cast<float>(p.v_px)}, 0.0f);
    const double px = std::hypot(static_cast<double>(seen.u_px) - p.u_px, static_cast<double>(seen.v_px) - p.v_px);
    const double mm = 1e3 * std::hypot(static_cast<double>(there.x_m) - p.x_m, static_cast<double>(there.y_m) - p.y_m);
    out.residual_px.rms += px * px;
    out.residual_mm.rms += mm * mm;
    out.residual_px.max = std::max(out.residual_px.max, px);
    out.residual_mm.max = std::max(out.residual_mm.max, mm);
  }
  const auto count = static_cast<double>(input.points.size());
  out.residual_px.rms = std::sqrt(out.residual_px.rms / count);
  out.residual_mm.rms = std::sqrt(out.residual_mm.rms / count);
}

double cross(PixelPoint a, PixelPoint b, PixelPoint c) {
  const double abu = static_cast<double>(b.u_px) - static_cast<double>(a.u_px);
  const double abv = static_cast<double>(b.v_px) - static_cast<double>(a.v_px);
  const double bcu = static_cast<double>(c.u_px) - static_cast<double>(b.u_px);
  const double bcv = static_cast<double>(c.v_px) - static_cast<double>(b.v_px);
  return abu * bcv - abv * bcu;
}

// Checks that the height is known, and that an estimated focal length is usual above fields. If one of four corners is
// wrong, the fit looks like a tilted, distant camera.
Result<void> check_height(const FieldFitInput& input, double misfit_px, double focal_px, const FieldFit& fit) {
  // Largest relative uncertainty of the height. Objects are up to a tenth of the camera height tall, so an error of 15
  // % moves them by millimeters at the border.
  constexpr double kHeightDoubt = 0.15;
  // Limit in standard deviations of the focal length's logarithm.
  constexpr double kFocalSigmas = 3;
  const double percent = std::min(100 * fit.height_sigma_m / fit.height_m, 999.0);
  if (!(fit.height_sigma_m < kHeightDoubt * fit.height_m)) {
    // Ratio of the misfit to kClickSigma_px above which a point counts as wrong; correct clicks miss by about
    // kClickSigma_px.
    constexpr double kMissed = 3;
    if (misfit_px > kMissed * kClickSigma_px) {
      return failure(
          ErrorCode::kInconsistent,
          "no camera fits the given points better than %.1f px (RMS), so its height is uncertain by %.0f %%: "
          "are all points where they belong? If so, the lens distorts: give more points, or measure the "
          "height of the lens above the floor and give --camera-height",
          misfit_px, percent);
    }
    return failure(
        ErrorCode::kInconsistent,
        "the camera points almost straight down, so its height and its focal length cannot be separated (height "
        "uncertain by %.0f %%): measure the height of the lens above the floor and give --camera-height",
        percent);
  }
  const double widths = focal_px / input.width_px;
  if (!input.camera_height_m && std::abs(std::log(widths / kFocalWidths)) > kFocalSigmas * kFocalSigma) {
    return failure(ErrorCode::kInconsistent,
                   "the given points fit only a camera %.1f m above the floor with a focal length of %.1f picture "
                   "widths: are all points where they belong? If so, measure the height of the lens above the floor "
                   "and give --camera-height",
                   fit.height_m, widths);
  }
  return {};
}

double distance(PixelPoint a, PixelPoint b) {
  return std::hypot(static_cast<double>(a.u_px) - static_cast<double>(b.u_px),
                    static_cast<double>(a.v_px) - static_cast<double>(b.v_px));
}

}  // namespace

Result<void> check_corners(const Corners& corners) {
  int clockwise = 0, counter = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint a = corners[i], b = corners[(i + 1) % 4], c = corners[(i + 2) % 4];
    const double turn = cross(a, b, c);
    // Sine of the smallest allowed angle at a corner, 2 degrees.
    constexpr double kStraight = 0.035;
    if (std::abs(turn) < std::max(1.0, kStraight * distance(a, b) * distance(b, c))) {
      return failure(ErrorCode::kInconsistent, "corners %zu, %zu and %zu lie on one line", i + 1, (i + 1) % 4 + 1,
                     (i + 2) % 4 + 1);
    }
    ++(turn > 0 ? clockwise : counter);  // v grows downwards
  }
  if (counter == 4) return {};
  if (clockwise == 4) {
    return failure(
        ErrorCode::kInconsistent,
        "the corners run clockwise in the picture, as in a mirror image; the order is -x-y, +x-y, +x+y, -x+y");
  }
  if (clockwise == 2) {
    return failure(ErrorCode::kInconsistent,
                   "the lines between the corners cross; the order is -x-y, +x-y, +x+y, -x+y, around the field");
  }
  return failure(ErrorCode::kInconsistent, "one corner lies inside the triangle of the others");
}

std::vector<FloorPoint> corner_points(const Corners& corners, double length_m, double width_m) {
  const std::array<std::array<double, 2>, 4> sign = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  std::vector<FloorPoint> points;
  for (std::size_t i = 0; i < 4; ++i) {
    points.push_back({sign[i][0] * length_m / 2, sign[i][1] * width_m / 2, static_cast<double>(corners[i].u_px),
                      static_cast<double>(corners[i].v_px)});
  }
  return points;
}

Result<void> fit_field(const FieldFitInput& input, FieldFit& out) {
  out = {};
  if (input.width_px <= 0 || input.height_px <= 0) {
    return Error{ErrorCode::kOutOfRange, "the picture has no size"};
  }
  if (input.points.size() < 4) {
    return failure(ErrorCode::kOutOfRange, "%zu points are given; at least four are needed", input.points.size());
  }
  const Center center{(input.width_px - 1) / 2.0, (input.height_px - 1) / 2.0};
  const auto homography = floor_to_picture(input.points, center.u_px, center.v_px);
  if (!homography) {
    return Error{ErrorCode::kInconsistent,
                 "the points do not determine the view of the floor (three of four on one line, or coincident points)"};
  }
  if (homography->determinant() > 0) {
    return failure(ErrorCode::kInconsistent,
                   "the points show the field mirrored; seen from above, y must be to the left of x");
  }

  // Starts from the closed-form solution if there is one and from several focal lengths, because a vertical camera has
  // no vanishing points.
  std::vector<double> focal_starts;
  if (const double w = inverse_focal_squared(*homography); w > 0) focal_starts.push_back(1.0 / std::sqrt(w));
  for (const double widths : {0.4, 0.6, 0.9, 1.35, 2.0, 3.0, 4.5}) focal_starts.push_back(widths * input.width_px);
  if (input.camera_height_m) {
    // The height is almost proportional to the focal length, so each focal length has its own start.
    const double unit = input.width_px;
    focal_starts.push_back(unit * *input.camera_height_m / pose_from(*homography, unit).position.z());
  }
  const Solver solver(input, center);
  CameraUnknowns best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double focal : focal_starts) {
    const CameraPose pose = pose_from(*homography, focal);
    CameraUnknowns x{focal,
                     {pose.rotation.x(), pose.rotation.y(), pose.rotation.z()},
                     {pose.position.x(), pose.position.y(), pose.position.z()},
                     0.0,
                     1.0};
    const double cost = solver.refine(x);
    if (cost < best_cost && x.focal_px > 0) {
      best_cost = cost;
      best = x;
    }
  }
  if (!std::isfinite(best_cost)) {
    return Error{ErrorCode::kInconsistent, "no camera above the floor fits the points"};
  }
  // Largest tolerated residual. A wrong order of the corners, or swapped length and width, leaves residuals of tens of
  // pixels; lens distortion that four corners cannot show leaves a few.
  const double tolerance_px = 0.015 * std::hypot(input.width_px, input.height_px);
  const double misfit_px = kClickSigma_px * std::sqrt(2.0 * best_cost / static_cast<double>(input.points.size()));
  if (misfit_px > tolerance_px) {
    return failure(ErrorCode::kInconsistent,
                   "no camera%s fits these points: residual %.1f px (RMS); is the order right, are length and "
                   "width exchanged, is --camera-height right?",
                   solver.has_free_aspect() ? "" : " with square pixels", misfit_px);
  }
  const Eigen::Vector3d turn(best.rotation.data());
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  out.tilt_rad = std::acos(std::clamp(-rotation(2, 2), -1.0, 1.0));
  // Overhead cameras of the leagues are tilted by less than 20 degrees; corners in a wrong order fit a camera only with
  // a tilt of 50 degrees.
  constexpr double kMaxTilt_rad = 0.7;
  if (out.tilt_rad > kMaxTilt_rad) {
    return failure(
        ErrorCode::kInconsistent,
        "the camera model found is tilted by %.0f degrees; is the order right, are length and width exchanged?",
        out.tilt_rad * 180.0 / std::numbers::pi);
  }
  out.height_m = best.position_m[2];
  out.height_sigma_m = solver.height_sigma_m(best);
  if (!input.camera_height_m) out.height_sigma_m *= solver.deviation_scale(misfit_px);
  if (!input.start_only) TOUCHLINE_TRY(check_height(input, misfit_px, best.focal_px, out));
  out.camera.kind = CameraModelKind::kFull;
  out.camera.full = full_model(best, center);
  out.has_distortion = solver.has_distortion();
  CameraModel camera;
  if (Status s = camera.configure(out.camera); !s.ok()) {
    return failure(s.code(), "the camera model found is invalid: %s", describe(s.code()));
  }
  add_residuals(input, camera, out);
  return fit_paper_model(input, out);
}

}  // namespace touchline::calibrate
