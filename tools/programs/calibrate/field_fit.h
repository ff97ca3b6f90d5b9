#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/status.h"
#include "core/types.h"

namespace touchline::calibrate {

/// A point of the floor whose place in the picture is known.
struct FloorPoint {
  double x_m = 0, y_m = 0;
  double u_px = 0, v_px = 0;
};

/// The field's corners in the order -x-y, +x-y, +x+y, -x+y.
using Corners = std::array<PixelPoint, 4>;

/// kInconsistent, with the reason, for corners that no camera above the field can show: on one line, crossing, not
/// convex, or mirrored (the order runs clockwise in the picture).
Status check_corners(const Corners& corners, std::string& reason);

/// The corners of a field of this size, as points of the floor.
std::vector<FloorPoint> corner_points(const Corners& corners, double length_m, double width_m);

/// What is known of the camera's height without looking.
struct HeightPrior {
  double height_m = 0, sigma_m = 0;
};

struct FieldFitInput {
  int width_px = 0, height_px = 0;
  std::vector<FloorPoint> points;         // at least four, no three of four on one line
  std::optional<double> camera_height_m;  // measured by a person: a prior of kHeightSigma_m
  bool start_only = false;                // a refinement follows: a height that is in doubt is no reason to refuse
};

// A tape measure from the floor to the lens.
constexpr double kHeightSigma_m = 0.02;
// How well a person clicks a corner.
constexpr double kClickSigma_px = 0.7;
// Lenses over fields see 45 to 100 degrees of it: focal length in widths of the picture, and the deviation of its
// logarithm. Alone it tells a vertical camera's height to a third.
constexpr double kFocalWidths = 0.8, kFocalSigma = 0.35;
// From here on k1 is found too, and with the height given the shape of the pixels (fy / fx): twelve equations for nine
// unknowns.
constexpr std::size_t kPointsForDistortion = 6;

struct ResidualSummary {
  double rms = 0, max = 0;
};

struct FieldFit {
  CameraParameters camera;                   // both models filled; kind: full
  ResidualSummary residual_px, residual_mm;  // of the full model at the points
  ResidualSummary paper_residual_mm;         // of Klancar's model, eq. (12)-(15) and the affine part
  double height_m = 0, height_sigma_m = 0;   // of the camera above the floor, from clicks of kClickSigma_px
  double tilt_rad = 0;                       // of the optical axis off the vertical
  bool has_distortion = false;
};

/// Finds the camera from points of the floor: homography (direct linear transform, Hartley's normalization), focal
/// length and pose from it in closed form (Zhang 2000, square pixels, principal point in the picture's center), then
/// least squares on pixels over focal length, pose and, with enough points, k1 (Brown 1971) and fy / fx. Klancar's
/// model is fitted beside. kOutOfRange: sizes, or too few points. kInconsistent, with the reason: points on a line,
/// mirrored, that do not fit a camera, or that cannot tell focal length from height (a nearly vertical camera) when no
/// height is given.
Status fit_field(const FieldFitInput& input, FieldFit& out, std::string& reason);

}  // namespace touchline::calibrate
