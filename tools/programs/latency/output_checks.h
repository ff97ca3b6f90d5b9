#pragma once

#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "tools/programs/latency/measure_command.h"

namespace touchline::latency {

/// kIo, kPermission: a file cannot be written; kInconsistent: one would replace another one. Creates and changes none.
Result<void> check_outputs(const Outputs& outputs);
/// kInconsistent: an output would replace one of these files, or be added to a folder of pictures.
Result<void> check_inputs_remain(const Outputs& outputs, const std::vector<std::string>& inputs);
/// The same for the three files, and a recording that replaces the camera.
Result<void> check_inputs_remain(const Outputs& outputs, const config::Configuration& configuration);

}  // namespace touchline::latency
