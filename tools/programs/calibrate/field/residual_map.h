#pragma once

#include "core/geometry/camera_model.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/field/field_refinement.h"

namespace touchline::calibrate {

/// Draws the residual of each point as a line over the darkened photograph, enlarged so that the 95th percentile is a
/// short line. The color shows the residual on the floor in millimeters. Includes a legend.
hal::Picture draw_residuals(const hal::Picture& photograph, const CameraModel& camera, const RefinementReport& report);

}  // namespace touchline::calibrate
