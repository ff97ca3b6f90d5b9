#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/calibrate/edge_search.h"
#include "tools/calibrate/field_fit.h"

namespace touchline::calibrate {

/// How well the drawing on the floor and the camera model found agree.
struct RefinementReport {
  std::size_t points = 0, outliers = 0;
  double rms_px = 0, p95_px = 0, max_px = 0;  // across the marks, outliers left out
  double rms_mm = 0, p95_mm = 0, max_mm = 0;
  double height_sigma_m = 0;
  std::vector<MarkPoint> found;
};

/// From a camera that is right to a few dozen pixels to one that is right to a tenth: finds the border and the center
/// line along their whole length, and adjusts focal length, principal point, radial (k1 to k3) and tangential
/// distortion and pose by nonlinear least squares on the distances across the marks, with a loss (Cauchy) that what is
/// not the border hardly moves; repeated while the search closes in. The drawing is `field`'s outline.
///
/// `fit` must hold a camera of fit_field(). kNotFound, with the reason, and `fit` as it was: too little of the border
/// could be found (fewer than kLeastSides sides), or it contradicts the points given.
Status refine_field(const LightPicture& picture, const FieldParameters& field,
                    const std::optional<double>& camera_height_m, FieldFit& fit, RefinementReport& report,
                    std::string& reason);

// All four: at a side that was not seen the lens would be extrapolated.
constexpr std::size_t kLeastSides = 4;

}  // namespace touchline::calibrate
