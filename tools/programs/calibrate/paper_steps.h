#pragma once

#include <array>
#include <optional>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/border_search.h"

namespace touchline::calibrate {

/// Where the straightened sides of the field meet, in homogeneous pixels from the picture's center: (x / w, y / w), or
/// w = 0 for a direction.
struct VanishingPoint {
  double x = 0, y = 0, w = 0;
};

/// Klancar's section 6.2 as it stands, without any refinement: what follows from the border found.
struct PaperSteps {
  double h_px = 0;                    // eq. (12)
  VanishingPoint along_x, along_y;    // of the sides along the field, and across it
  double rotation_rad = 0;            // of the field's x in the picture, rows growing downwards
  double p_per_px = 0, q_per_px = 0;  // eq. (14), (15)
  PaperModelParameters model;  // with the affine part that the field's size settles; the camera's place is not known
};

/// Vanishing points of the straightened sides, and from them the rotation and p and q: eq. (15) for a field whose sides
/// are turned by that rotation, p X + q Y = 1 being the line through both points; then two scales, shear and offset
/// from the corners. `quarter_turned`: x runs upwards in the picture. None: the corners lie on a line.
std::optional<PaperSteps> paper_steps(const BorderSearch& border, bool quarter_turned, int width_px, int height_px,
                                      const FieldParameters& field);

}  // namespace touchline::calibrate
