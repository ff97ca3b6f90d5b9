#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/types.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// A point on the floor and its pixel.
struct FloorPoint {
  double x_m = 0, y_m = 0;
  double u_px = 0, v_px = 0;
};

/// The corners of the field in the order -x-y, +x-y, +x+y, -x+y.
using Corners = std::array<PixelPoint, 4>;

/// Checks that a camera above the field can see these corners. kInconsistent, with the reason: three corners on one
/// line, crossing sides, not convex, or mirrored (clockwise in the picture).
Result<void> check_corners(const Corners& corners);

/// Returns the corners of a field of this size with their pixels.
std::vector<FloorPoint> corner_points(const Corners& corners, double length_m, double width_m);

/// Prior of the camera height.
struct HeightPrior {
  double height_m = 0, sigma_m = 0;
};

struct FieldFitInput {
  int width_px = 0, height_px = 0;
  std::vector<FloorPoint> points;         // at least four, of which no three lie on one line
  std::optional<double> camera_height_m;  // height measured by a person, with standard deviation kHeightSigma_m
  bool start_only = false;                // a refinement follows: accept an uncertain height
  bool free_aspect = false;               // free the pixel aspect ratio even with few points, if the height is given
};

// Standard deviation of a height measured with a tape from the floor to the lens.
constexpr double kHeightSigma_m = 0.02;
// Standard deviation of a click on a corner.
constexpr double kClickSigma_px = 0.7;
// Prior of the focal length: lenses above fields see 45 to 100 degrees of the picture width. Expected focal length in
// picture widths, and standard deviation of its logarithm. This prior alone determines the height of a vertical camera
// to a third.
constexpr double kFocalWidths = 0.8, kFocalSigma = 0.35;
// With at least this number of points, k1 is estimated too, and if the height is given, the pixel aspect ratio (fy /
// fx): twelve equations for nine unknowns.
constexpr std::size_t kPointsForDistortion = 6;

struct ResidualSummary {
  double rms = 0, max = 0;
};

struct FieldFit {
  CameraParameters camera;                   // both models are set; kind: full
  ResidualSummary residual_px, residual_mm;  // residuals of the full model at the points
  ResidualSummary paper_residual_mm;         // residual of Klancar's model, eq. (12)-(15) and the affine part
  // Height of the camera above the floor. Its standard deviation follows from kClickSigma_px, or from the misfit if
  // that is larger.
  double height_m = 0, height_sigma_m = 0;
  double tilt_rad = 0;  // angle between the optical axis and the vertical
  bool has_distortion = false;
};

/// kOutOfRange: wrong picture size, or too few points. kInconsistent, with the reason: the points lie on a line, are
/// mirrored, or fit no camera. If no height is given, also: focal length and height cannot be separated (a nearly
/// vertical camera), or are unusual above a field.
Result<void> fit_field(const FieldFitInput& input, FieldFit& out);

}  // namespace touchline::calibrate
