#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/programs/calibrate/camera_adjustment.h"
#include "tools/programs/calibrate/edge_search.h"
#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// What became of one mark of the drawing.
struct MarkReport {
  std::size_t looked_at = 0, found = 0;  // points along it
  double offset_px = 0;                  // mean distance from where the camera found from the border has it
  bool used = false;
};

/// How well the drawing on the floor and the camera model found agree.
struct RefinementReport {
  std::size_t points = 0, outliers = 0;
  double rms_px = 0, p95_px = 0, max_px = 0;  // across the marks, outliers left out
  double rms_mm = 0, p95_mm = 0, max_mm = 0;
  double edge_sigma_px = 0;  // of a point as if all were independent: neighbors err alike
  CameraUncertainty sigma;
  std::vector<MarkReport> marks;  // one a mark
  std::vector<MarkPoint> found;   // without the outliers
};

/// From a camera that is right to a few dozen pixels to one that is right to a tenth: finds the border and the long
/// lines along their whole length, and adjusts the camera (see Adjustment) with a loss that what is not the border
/// hardly moves; repeated while the search closes in. Then the other markings join, each if it is found where the
/// drawing has it (kMarkingTolerance_px): a league's drawing need not be what a hall has on its floor.
///
/// `fit` must hold a camera of fit_field(). `height`: what is known of it. With the reason, and `fit` as it was, when
/// the result is not to be trusted: kNotFound: too little of the border was found, or the picture cuts it off;
/// kInconsistent: it contradicts the size, or residuals or deviations are too large.
Status refine_field(const LightPicture& picture, const FieldParameters& field, const std::vector<Mark>& marks,
                    const std::optional<HeightPrior>& height, FieldFit& fit, RefinementReport& report,
                    std::string& reason);

// A mean farther off means another drawing: the border alone places a mark to a tenth of a pixel.
inline constexpr double kMarkingTolerance_px = 0.35;

}  // namespace touchline::calibrate
