#pragma once

#include <string>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/status.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// Draws the drawing's marks and the goals in red where the camera model has them, and the points that the model was
/// fitted to as green crosses.
void draw_field(const CameraModel& camera, const FieldParameters& field, const std::vector<Mark>& marks,
                const std::vector<FloorPoint>& points, hal::Picture& picture);

}  // namespace touchline::calibrate
