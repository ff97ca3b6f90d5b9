#pragma once

#include <string>

#include "tools/calibrate/field_fit.h"

namespace touchline::calibrate {

/// Klancar's model through the same points: H of eq. (12), p and q of eq. (14), (15) and the affine part that remains.
/// Starts from the full model in `fit`, and fills its `camera.paper` and `paper_residual_mm`.
Status fit_paper_model(const FieldFitInput& input, FieldFit& fit, std::string& reason);

}  // namespace touchline::calibrate
