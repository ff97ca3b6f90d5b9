#pragma once

#include <array>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// Fits Klancar's model to the same points as the full model: H of eq. (12), p and q of eq. (14) and (15), and the
/// remaining affine part. Starts from the full model in `fit` and sets its `camera.paper` and `paper_residual_mm`.
Result<void> fit_paper_model(const FieldFitInput& input, FieldFit& fit);

/// Computes the distances between the points and their positions according to this model.
ResidualSummary paper_residual(const PaperModelParameters& model, const std::vector<FloorPoint>& points);

/// Returns the k1, k2 and k3 of Brown's model that approximate eq. (12) best for a lens with this focal length, up to
/// `radius_px` from the center of the picture (least squares).
std::array<double, 3> brown_of_eq12(double h_px, double focal_px, double radius_px);

}  // namespace touchline::calibrate
