#pragma once

#include <nlohmann/json_fwd.hpp>

#include "firmware/snapshot.h"

namespace touchline::console {

/// Returns the message `step` for the setup program: what a frame shows of robot `robot`, and what was sent to it
/// (docs/console-protocol.md).
nlohmann::json tested_robot_json(const Snapshot& snapshot, RobotId robot);

}  // namespace touchline::console
