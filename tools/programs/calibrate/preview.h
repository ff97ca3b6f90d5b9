#pragma once

#include <string>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/status.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/edge_search.h"
#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// Draws what the model says over the photograph: the drawing's marks and the goals in red; the points that it was
/// found from as green crosses.
void draw_field(const CameraModel& camera, const FieldParameters& field, const std::vector<Mark>& marks,
                const std::vector<FloorPoint>& points, hal::Picture& picture);

}  // namespace touchline::calibrate
