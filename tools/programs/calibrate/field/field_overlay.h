#pragma once

#include <string>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/status.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// Draws marks and goals in red where the camera model projects them, and the fitted points as green crosses.
void draw_field(const CameraModel& camera, const FieldParameters& field, const std::vector<Mark>& marks,
                const std::vector<FloorPoint>& points, hal::Picture& picture);

}  // namespace touchline::calibrate
