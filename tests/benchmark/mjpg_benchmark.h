#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tests/benchmark/measurement.h"

namespace touchline::testing {

/// Part of the names of cases whose pictures have the size that USB cameras send.
constexpr const char* kCameraSize = ", 15 kB,";

/// Compresses an RGB24 picture to at most 15 kB as USB cameras do, with chroma for 2 x 2 pixels (4:2:0).
std::vector<std::uint8_t> camera_jpeg(const Frame& frame);

/// Adds cases whose names contain `filter` and that process pictures of a USB camera (JPEG, 4:2:2 and 4:2:0; of quality
/// 80, or at most 15 kB), decoded to planar YUV as the driver does, and for comparison to RGB:
/// - "mjpg ... field 640x480": JPEG to regions of a drawn field;
/// - "mjpg ... vsss-bar": the same of a real picture, if the environment variable TOUCHLINE_SHARED names its folder;
/// - "mjpg ... step": JPEG to packet, in the game of StepBenchmark.
/// kInconsistent: too few patches or robots are found. Other errors: of files.
Result<void> add_mjpg_cases(BenchmarkCases& cases, const std::string& filter);

}  // namespace touchline::testing
