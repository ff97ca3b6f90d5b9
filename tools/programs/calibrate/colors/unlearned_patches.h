#pragma once

#include "core/geometry/camera_model.h"
#include "tools/programs/calibrate/colors/auto_detect.h"

// Patches that auto_detect_colors() found and that no color is learned from.
namespace touchline::calibrate {

/// Adds unrecognized patches to DetectedColors::unclear: such a patch may belong to a robot in other light, so it is no
/// background for a color like its own. White dots and crosses are background.
void leave_out_similar(DetectedColors& out);

/// Finds DetectedColors::things: patches that look like a team's color in other light, but are on none of its robots.
void find_things(const CameraModel& camera, DetectedColors& out);

}  // namespace touchline::calibrate
