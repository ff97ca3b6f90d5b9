#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// Klancar's model through the same points: H of eq. (12), p and q of eq. (14), (15) and the affine part that remains.
/// Starts from the full model in `fit`, and fills its `camera.paper` and `paper_residual_mm`.
Status fit_paper_model(const FieldFitInput& input, FieldFit& fit, std::string& reason);

/// How far this model, as it is, puts the points from where they are on the floor.
ResidualSummary paper_residual(const PaperModelParameters& model, const std::vector<FloorPoint>& points);

}  // namespace touchline::calibrate
