#include "tools/programs/calibrate/field/field_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "tools/programs/calibrate/field/fit_checks.h"
#include "tools/programs/calibrate/field/paper_fit.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Spacing of the points along a mark; closer points would share the same pixels.
constexpr double kStep_px = 3.0;
// Rounds of the search: reach, and scale of the loss. After a fit to four corners without distortion, the middles of
// the sides are two dozen pixels off with a wide-angle lens; the last rounds only let the fit converge. Values are for
// a picture of width kReferenceWidth_px; wider pictures have more pixels for the same lens.
struct Round {
  double reach_px, loss_px;
  int lens;  // as in AdjustmentWeights
  bool all;  // use markings too, and weigh points by their measured scatter
};
constexpr double kReferenceWidth_px = 640;
constexpr std::array<Round, 8> kRounds{{{30, 4, 1, false},
                                        {16, 2, 2, false},
                                        {10, 1, 2, false},
                                        {8, 0.5, 3, false},
                                        {8, 0.3, 3, false},
                                        {8, 0.3, 3, true},
                                        {8, 0.3, 3, true},
                                        {8, 0.3, 3, true}}};
// Standard deviation of the position of a blurred edge before the scatter is known, and its bounds.
constexpr double kEdgeSigma_px = 0.15, kMinSigma_px = 0.04, kMaxSigma_px = 1.5;
// Outlier limit: points with a larger residual belong to another object.
constexpr double kOutlier_px = 1.0;
// Edges with a smaller residual are considered correct.
constexpr double kClean_px = 0.17;
// Least share of points found along a marking that counts as present.
constexpr double kMinSeen = 0.5;

// Signed distance from the model to the point found, perpendicular to its mark.
double off_px(const CameraModel& camera, const MarkPoint& p) {
  const PixelPoint at = camera.to_pixel({static_cast<float>(p.x_m), static_cast<float>(p.y_m)}, 0.0f);
  return (static_cast<double>(at.u_px) - p.u_px) * p.across_u + (static_cast<double>(at.v_px) - p.v_px) * p.across_v;
}

// Returns the standard deviation that each point must get so that the normal equations account for correlation.
// Residuals of neighbors along a mark are correlated (lens model, bent walls, Bayer pattern): n of them carry the
// information of n / c independent ones, where c is 1 plus twice the sum of the autocorrelations.
double independent_sigma(const CameraModel& camera, const std::vector<MarkPoint>& points) {
  std::vector<double> residuals;
  std::vector<std::size_t> mark;
  for (const MarkPoint& p : points) {
    const double off = off_px(camera, p);
    if (std::abs(off) > kOutlier_px) continue;
    residuals.push_back(off);
    mark.push_back(p.mark);
  }
  if (residuals.size() < 20) return kEdgeSigma_px;
  double square = 0;
  for (const double r : residuals) square += r * r / static_cast<double>(residuals.size());
  double correlation = 1;
  constexpr std::size_t kFarthest = 40;
  for (std::size_t lag = 1; lag <= kFarthest; ++lag) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i + lag < residuals.size(); ++i) {
      if (mark[i] != mark[i + lag]) continue;
      sum += residuals[i] * residuals[i + lag];
      ++count;
    }
    const double part = count > 0 && square > 0 ? sum / (static_cast<double>(count) * square) : 0;
    if (part < 0.05) break;
    correlation += 2 * part;
  }
  return std::clamp(std::sqrt(square * correlation), kMinSigma_px, kMaxSigma_px);
}

// Selects the points to use: points of the border and of long lines, and points of other markings whose positions agree
// with the drawing.
std::vector<MarkPoint> agreeing(const CameraModel& camera, const std::vector<Mark>& marks,
                                const std::vector<MarkPoint>& points, RefinementReport& report) {
  std::vector<double> sum(marks.size());
  std::vector<std::size_t> near(marks.size());
  for (const MarkPoint& p : points) {
    const double off = off_px(camera, p);
    if (std::abs(off) > kOutlier_px) continue;
    sum[p.mark] += off;
    ++near[p.mark];
  }
  for (std::size_t m = 0; m < marks.size(); ++m) {
    MarkReport& mark = report.marks[m];
    mark.found = near[m];
    mark.offset_px = near[m] > 0 ? sum[m] / static_cast<double>(near[m]) : 0;
    mark.used =
        marks[m].side >= 0 || (static_cast<double>(near[m]) >= kMinSeen * static_cast<double>(mark.tried_points) &&
                               near[m] >= 3 && std::abs(mark.offset_px) < kMarkingTolerance_px);
  }
  std::vector<MarkPoint> kept;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kept),
               [&](const MarkPoint& p) { return report.marks[p.mark].used; });
  return kept;
}

void add_residuals(const CameraModel& camera, RefinementReport& report) {
  std::vector<double> pixels, millimeters;
  std::vector<MarkPoint> kept;
  for (const MarkPoint& p : report.found) {
    const double off = std::abs(off_px(camera, p));
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
  const statistics::ErrorSummary px = statistics::summarize(std::move(pixels));
  const statistics::ErrorSummary mm = statistics::summarize(std::move(millimeters));
  report.rms_px = px.rms;
  report.p95_px = px.p95;
  report.max_px = px.max;
  report.rms_mm = mm.rms;
  report.p95_mm = mm.p95;
  report.max_mm = mm.max;
}

// Fits the points with the height free, and compares the result with the given height. The weights come from the
// scatter about this free fit, because a wrong height bends the marks, which would look like scatter.
HeightEvidence height_evidence(const Adjustment& adjustment, const std::vector<MarkPoint>& points,
                               AdjustmentWeights weights, const AdjustedCamera& start, const FieldParameters& field,
                               const std::optional<HeightPrior>& given) {
  const Adjustment free_height = adjustment.of_any_focal_length(std::nullopt);
  AdjustedCamera free_camera = start;
  HeightEvidence out;
  CameraParameters parameters;
  CameraModel model;
  if (!free_height.run(points, weights, free_camera)) return out;
  parameters.full = free_camera.full();
  if (!model.configure(parameters).ok()) return out;
  weights.edge_sigma_px = independent_sigma(model, points);
  if (!free_height.run(points, weights, free_camera)) return out;
  out.height_m = free_camera.position_m[2];
  out.sigma_m = free_height.uncertainty(points, weights, free_camera, field).height_m;
  const Adjustment given_height = adjustment.of_any_focal_length(given);
  AdjustedCamera given_camera = start;
  if (!given || !given_height.run(points, weights, given_camera)) return out;
  out.chi_square = std::max(0.0, given_height.chi_square(points, weights, given_camera) -
                                     free_height.chi_square(points, weights, free_camera));
  return out;
}

Result<void> refine(const LightPicture& picture, const FieldParameters& field, const std::vector<Mark>& marks,
                    const std::optional<HeightPrior>& height, FieldFit& fit, RefinementReport& report) {
  report = {};
  report.marks.resize(marks.size());
  std::vector<Mark> early;
  std::vector<std::size_t> of_early;
  for (std::size_t m = 0; m < marks.size(); ++m) {
    if (!marks[m].early) continue;
    early.push_back(marks[m]);
    of_early.push_back(m);
  }
  AdjustedCamera camera = AdjustedCamera::of(fit.camera.full);
  const Adjustment adjustment(picture.width_px(), picture.height_px(), height, camera);
  const double zoom = std::max(1.0, picture.width_px() / kReferenceWidth_px);
  CameraParameters parameters = fit.camera;
  CameraModel model;
  AdjustmentWeights weights{kEdgeSigma_px, 0, 0};
  for (std::size_t i = 0; i <= kRounds.size(); ++i) {
    if (!model.configure(parameters).ok()) {
      return Error{ErrorCode::kNotFound, "no plausible camera model fits the border"};
    }
    const bool last = i == kRounds.size();
    const Round& round = kRounds[last ? i - 1 : i];
    const double reach_px = round.all ? round.reach_px : round.reach_px * zoom;
    std::vector<std::size_t> tried_points;
    report.found = find_marks(picture, model, round.all ? marks : early, kStep_px, reach_px, &tried_points);
    if (round.all) {
      for (std::size_t m = 0; m < marks.size(); ++m) report.marks[m].tried_points = tried_points[m];
      report.found = agreeing(model, marks, report.found, report);
      weights.edge_sigma_px = independent_sigma(model, report.found);
    } else {
      std::vector<std::size_t> tried(marks.size());
      for (MarkPoint& p : report.found) p.mark = of_early[p.mark];
      for (std::size_t e = 0; e < early.size(); ++e) tried[of_early[e]] = tried_points[e];
      tried_points = tried;
    }
    TOUCHLINE_TRY(check_sides(marks, tried_points, report.found));
    if (last) break;
    weights.loss_px = round.all ? std::max(round.loss_px, 2 * weights.edge_sigma_px) : round.loss_px;
    weights.lens = round.lens;
    if (!adjustment.run(report.found, weights, camera)) {
      return Error{ErrorCode::kNotFound, "the border and the points given contradict each other"};
    }
    parameters.full = camera.full();
  }
  report.edge_sigma_px = weights.edge_sigma_px;
  report.sigma = adjustment.uncertainty(report.found, weights, camera, field);
  report.height = height_evidence(adjustment, report.found, weights, camera, field, height);
  add_residuals(model, report);
  // Checks the sides again: a side whose points are mostly outliers was not found.
  std::vector<std::size_t> tried_points;
  for (const MarkReport& mark : report.marks) tried_points.push_back(mark.tried_points);
  TOUCHLINE_TRY(check_sides(marks, tried_points, report.found));
  FieldFit refined = fit;
  refined.camera.full = parameters.full;
  refined.has_distortion = true;
  refined.height_m = camera.position_m[2];
  refined.height_sigma_m = report.sigma.height_m;
  const Eigen::Vector3d turn(camera.rotation.data());
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  refined.tilt_rad = std::acos(std::clamp(-rotation(2, 2), -1.0, 1.0));
  TOUCHLINE_TRY(
      check_camera(PictureSize{picture.width_px(), picture.height_px(), zoom}, field, model, refined, report));
  FieldFitInput input;
  input.width_px = picture.width_px();
  input.height_px = picture.height_px();
  for (const MarkPoint& p : report.found) input.points.push_back({p.x_m, p.y_m, p.u_px, p.v_px});
  if (const Result<void> paper = fit_paper_model(input, refined); !paper.ok()) {
    return Error{ErrorCode::kNotFound, paper.error().text};
  }
  fit = refined;
  return {};
}

// Returns the misfit; each outlier counts with the outlier limit.
double misfit(const RefinementReport& report) {
  const auto points = static_cast<double>(report.points), outliers = static_cast<double>(report.outliers);
  return (points * report.rms_px * report.rms_px + outliers * kOutlier_px * kOutlier_px) / (points + outliers);
}

}  // namespace

Result<void> refine_field(const LightPicture& picture, const FieldParameters& field, const std::vector<Mark>& marks,
                          const std::optional<HeightPrior>& height, FieldFit& fit, RefinementReport& report) {
  const FieldFit start = fit;
  Result<void> result = refine(picture, field, marks, height, fit, report);
  if (result.ok() && misfit(report) < kClean_px * kClean_px) return {};
  // A wall has a side and a top; find out which of their edges is visible all around.
  std::vector<Mark> inner = marks;
  for (Mark& mark : inner) mark.innermost = mark.kind == MarkKind::kBorder;
  FieldFit other = start;
  RefinementReport other_report;
  const Result<void> other_result = refine(picture, field, inner, height, other, other_report);
  if (!other_result.ok() || (result.ok() && misfit(report) <= misfit(other_report))) return result;
  fit = other;
  report = std::move(other_report);
  return {};
}

}  // namespace touchline::calibrate
