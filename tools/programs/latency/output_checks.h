#pragma once

#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "tools/programs/latency/measure_command.h"

namespace touchline::latency {

/// Checks the outputs. kIo, kPermission: a file cannot be written; kInconsistent: one would replace another one. No
/// file is created or changed.
Result<void> check_outputs(const Outputs& outputs);
/// Checks that the inputs are kept. kInconsistent: an output would replace one of these files, or be added to a folder
/// of pictures.
Result<void> check_inputs_remain(const Outputs& outputs, const std::vector<std::string>& inputs);
/// As above, for the three configuration files, and for a recording that replaces the camera.
Result<void> check_inputs_remain(const Outputs& outputs, const config::Configuration& configuration);

}  // namespace touchline::latency
