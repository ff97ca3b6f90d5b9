#pragma once

#include "core/geometry/camera_model.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/field_refinement.h"

namespace touchline::calibrate {

/// Over the darkened photograph, from each point found the distance to where the model has it, enlarged so that the
/// 95th percentile is a short stroke; its color says how many millimeters it is on the floor. With a legend.
hal::Picture draw_errors(const hal::Picture& photograph, const CameraModel& camera, const RefinementReport& report);

}  // namespace touchline::calibrate
