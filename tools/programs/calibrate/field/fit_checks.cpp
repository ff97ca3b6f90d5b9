#include "tools/programs/calibrate/field/fit_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace touchline::calibrate {

Result<void> check_sides(const std::vector<Mark>& marks, const std::vector<std::size_t>& tried_points,
                         const std::vector<MarkPoint>& found) {
  std::array<std::size_t, 4> tried{}, seen{};
  for (std::size_t m = 0; m < marks.size(); ++m) {
    if (marks[m].side >= 0) tried[static_cast<std::size_t>(marks[m].side)] += tried_points[m];
  }
  for (const MarkPoint& p : found) {
    if (marks[p.mark].side >= 0) ++seen[static_cast<std::size_t>(marks[p.mark].side)];
  }
  std::size_t sides = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    sides += static_cast<double>(seen[i]) > kMinSideShare * static_cast<double>(tried[i]) ? 1u : 0u;
  }
  if (sides == 4) return {};
  return failure(ErrorCode::kNotFound, "only %zu of the four sides of the border were found", sides);
}

Result<void> check_camera(const PictureSize& picture, const FieldParameters& field, const CameraModel& model,
                          const FieldFit& fit, const RefinementReport& report) {
  constexpr int kSteps = 100;
  int outside = 0;
  const float x = field.length_m / 2, y = field.width_m / 2;
  for (int i = 0; i < kSteps; ++i) {
    const float t = 2 * (static_cast<float>(i) + 0.5f) / kSteps - 1;
    for (const FieldPoint& at : {FieldPoint{t * x, -y}, {t * x, y}, {-x, t * y}, {x, t * y}}) {
      const PixelPoint p = model.to_pixel(at, 0.0f);
      const bool inside = p.u_px >= 0 && p.v_px >= 0 && p.u_px <= static_cast<float>(picture.width_px - 1) &&
                          p.v_px <= static_cast<float>(picture.height_px - 1);
      outside += inside ? 0 : 1;
    }
  }
  if (outside > kMaxOutsideShare * 4 * kSteps) {
    return failure(ErrorCode::kNotFound,
                   "the picture cuts off %.0f %% of the border: turn or raise the camera, or use a wider lens",
                   100.0 * outside / (4 * kSteps));
  }
  if (static_cast<double>(report.outliers) > kMaxOutlierShare * static_cast<double>(report.points + report.outliers)) {
    return failure(
        ErrorCode::kInconsistent,
        "%zu of %zu points found along the border and the markings do not fit the drawing of the field; is the size "
        "of the field right, and is the border free of objects?",
        report.outliers, report.points + report.outliers);
  }
  if (report.rms_px > kMaxRms_px * picture.zoom) {
    return failure(
        ErrorCode::kInconsistent,
        "the drawing of the field differs from the picture by %.2f px (RMS; at most %.2f is accepted); are length and "
        "width "
        "right?",
        report.rms_px, kMaxRms_px * picture.zoom);
  }
  if (!(report.sigma.lens_chi_square < kMaxLensChiSquare)) {
    return failure(
        ErrorCode::kInconsistent,
        "the camera model found is implausible (%.1f m high, %.0f degrees off the vertical, focal length %.0f px, "
        "center "
        "%.0f, %.0f px, k1 %.2f): are length and width right, and is the picture as the camera delivers it?",
        fit.height_m, fit.tilt_rad * 180.0 / std::numbers::pi, static_cast<double>(fit.camera.full.fx_px),
        static_cast<double>(fit.camera.full.cx_px), static_cast<double>(fit.camera.full.cy_px),
        static_cast<double>(fit.camera.full.k1));
  }
  // Overhead cameras of the leagues are tilted by less than 20 degrees.
  constexpr double kMaxTilt_rad = 0.7;
  if (fit.tilt_rad > kMaxTilt_rad) {
    return failure(ErrorCode::kInconsistent,
                   "the camera model found is tilted by %.0f degrees; is the size of the field right?",
                   fit.tilt_rad * 180.0 / std::numbers::pi);
  }
  if (!(report.sigma.floor_corner_mm < kMaxFloorSigma_mm)) {
    return failure(
        ErrorCode::kInconsistent,
        "the corners of the field are uncertain by %.1f mm (standard deviation): too little of the border is "
        "visible, or its contrast is too low",
        std::min(report.sigma.floor_corner_mm, 999.0));
  }
  if (!(report.sigma.top_corner_mm < kMaxTopSigma_mm)) {
    return failure(
        ErrorCode::kInconsistent,
        "the camera points almost straight down, so its height and its focal length cannot be separated (%.2f m +- "
        "%.2f: the top of a robot in a corner would be %.0f mm off): measure the height of the lens above the "
        "floor and enter it",
        fit.height_m, std::min(report.sigma.height_m, 99.0), std::min(report.sigma.top_corner_mm, 999.0));
  }
  return {};
}

}  // namespace touchline::calibrate
