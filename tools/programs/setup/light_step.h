#pragma once

#include <string>

#include "hal/result.h"
#include "tools/programs/setup/job.h"

namespace touchline::setup {

/// Measures the light in the frames, and writes the map and the section [light] of the venue file. Errors of
/// calibrate_light().
Result<void> measure_light(const std::string& surface, bool keep_normal, const JobInput& input,
                           const JobOutput& output);

}  // namespace touchline::setup
