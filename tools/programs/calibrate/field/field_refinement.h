#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/field/camera_adjustment.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// Result for one mark of the drawing.
struct MarkReport {
  std::size_t tried_points = 0, found = 0;  // number of points along the mark
  double offset_px = 0;                     // mean distance from the position that the border alone predicts
  bool used = false;
};

/// Agreement between the drawing of the field and the camera model.
struct RefinementReport {
  std::size_t points = 0, outliers = 0;
  double rms_px = 0, p95_px = 0, max_px = 0;  // residuals perpendicular to the marks, without outliers
  double rms_mm = 0, p95_mm = 0, max_mm = 0;
  double edge_sigma_px = 0;  // standard deviation per point, increased to account for correlated neighbors
  CameraUncertainty sigma;
  HeightEvidence height;
  std::vector<MarkReport> marks;  // one per mark
  std::vector<MarkPoint> found;   // points found, without outliers
};

/// Refines a camera model that is a few dozen pixels off to a tenth of a pixel. Finds the border and the long lines
/// along their whole length and adjusts the camera (see Adjustment) with a robust loss, repeatedly, while the reach of
/// the search shrinks. Then each other marking is added if it is found within kMarkingTolerance_px of its drawing,
/// because the markings of a real field can differ from those of the league.
///
/// `fit` must hold a camera of fit_field(); it is unchanged on failure. `height`: prior of the camera's height. Errors,
/// with the reason: kNotFound: too little of the border was found, or the picture cuts it off. kInconsistent: the
/// border contradicts the size of the field, or residuals or uncertainties are too large.
Result<void> refine_field(const LightPicture& picture, const FieldParameters& field, const std::vector<Mark>& marks,
                          const std::optional<HeightPrior>& height, FieldFit& fit, RefinementReport& report);

// Largest mean offset of a marking that agrees with its drawing. It is larger than the error of a mark's position that
// follows from the border alone, a tenth of a pixel.
inline constexpr double kMarkingTolerance_px = 0.35;

}  // namespace touchline::calibrate
