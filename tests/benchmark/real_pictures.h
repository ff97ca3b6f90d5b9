#pragma once

#include <string>

#include "hal/result.h"
#include "tests/benchmark/measurement.h"

namespace touchline::testing {

// Sets of real pictures in ../shared/footage with venues of tests/footage in RGB.
inline constexpr std::array kRealSets{"vss-overhead", "vsss-bar-normal", "vsss-halves"};

/// Adds "real " and the name of each set of kRealSets whose name contains `filter`, if the environment variable
/// TOUCHLINE_SHARED names the folder that contains footage/: reading, scan, the method of ssl-vision and the whole
/// step, each on all pictures of the set in turn. Errors of files and configurations.
Result<void> add_real_pictures(BenchmarkCases& cases, const std::string& filter);

}  // namespace touchline::testing
