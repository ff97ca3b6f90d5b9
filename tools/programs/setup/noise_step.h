#pragma once

#include "hal/result.h"
#include "tools/programs/calibrate/noise/noise_recorder.h"
#include "tools/programs/setup/job.h"

namespace touchline::setup {

/// Writes [noise] of the venue file from the recorded frames of robots at rest. Errors of NoiseRecorder::report() and
/// write_sections().
Result<void> write_noise(const calibrate::NoiseRecorder& recorder, const JobInput& input, const JobOutput& output);

}  // namespace touchline::setup
