#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// Writes the errors of poses and of the ball's position that follow from the errors of the regions' centroids. The
/// sub-pixel fits replace them by smaller ones. `teams` is indexed by Team.
void write_centroid_noise(const CameraModel& camera, const std::array<TeamMarking, 2>& teams, float ball_radius_m,
                          Sightings& out);

}  // namespace touchline
