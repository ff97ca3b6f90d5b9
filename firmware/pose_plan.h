#pragma once

#include "firmware/config/configuration.h"
#include "hal/linux/network/pose_camera.h"
#include "hal/result.h"

namespace touchline {

/// Returns what a source of poses knows of the teams.
hal::PoseTeams pose_teams(const config::TeamFile& team);

/// Returns the settings of a camera that takes poses (camera.backend = "poses"). kInconsistent: the address or the
/// interface cannot be used; the message has the line of the key.
Result<hal::PoseCameraSettings> plan_poses(const config::Configuration& configuration);

}  // namespace touchline
