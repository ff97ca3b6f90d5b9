#pragma once

#include <string>

#include "firmware/config/configuration.h"

// Boards whose camera is a source of poses (camera.backend = "poses"), and whose radio is a simulator.
namespace touchline::config {

[[nodiscard]] inline bool takes_poses(const BoardFile& board) {
  return board.camera.backend == hal::CameraBackend::kPoses;
}

/// Checks venue and team for a source of poses and fills `configuration.pipeline`: the venue needs only the field, the
/// robots need ids but no colors. Adds the names of team and ball colors to the venue's colors, so that reports and the
/// page can show them. Errors of resolve_team().
Result<void> resolve_for_poses(Configuration& configuration);

/// Replaces the backends "firasim" and "grsim" by "udp" with the address of this simulator, unless there is one, and
/// keeps the format of its packets.
void use_simulator(hal::RadioPortSettings& port);

/// Returns the format of the packets that the board's simulators understand; "" if no radio is a simulator.
std::string simulator_format(const hal::RadioSettings& radio);

}  // namespace touchline::config
