#pragma once

#include <array>
#include <optional>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/field/border_search.h"

namespace touchline::calibrate {

/// Intersection of two straightened sides of the field in homogeneous pixels relative to the center of the picture: (x
/// / w, y / w); w = 0 for a direction.
struct VanishingPoint {
  double x = 0, y = 0, w = 0;
};

/// Result of Klancar section 6.2 without refinement.
struct VanishingPointModel {
  double h_px = 0;                    // H of eq. (12)
  VanishingPoint along_x, along_y;    // vanishing points of the sides along the field and across it
  double rotation_rad = 0;            // direction of the field's x axis in the picture; v grows downwards
  double p_per_px = 0, q_per_px = 0;  // p and q of eq. (14), (15)
  PaperModelParameters model;         // the affine part follows from the field's size; the camera position is unknown
};

/// Computes the vanishing points of the straightened sides, then rotation, p and q: eq. (15) for a field whose sides
/// are rotated by that angle; p X + q Y = 1 is the line through both points. The two scales, shear and offset follow
/// from the corners. `quarter_turned`: x points upwards in the picture. Empty if the corners lie on a line.
std::optional<VanishingPointModel> vanishing_point_model(const BorderSearch& border, bool quarter_turned, int width_px,
                                                         int height_px, const FieldParameters& field);

}  // namespace touchline::calibrate
