#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "hal/result.h"
#include "tests/benchmark/measurement.h"

namespace touchline::testing {

// Sets of real pictures in ../shared/footage; tests/footage has their venues in RGB.
inline constexpr std::array kRealSets{"vss-overhead", "vsss-bar-normal", "vsss-halves"};

// Suffix of the name of a scan that reads every row, even where a venue's least height makes this unnecessary. Its time
// is the unit of the step's time; with a faster scan as the unit, the step would seem slower.
inline constexpr char kEveryRow[] = ", every row";

/// Largest number of pictures of a set. It is odd, because each measured call follows an unmeasured one.
constexpr std::size_t kMaxRealPictures = 25;

/// Adds "real " and the name of each set of kRealSets whose name contains `filter`, if the environment variable
/// TOUCHLINE_SHARED names the folder that contains footage/: reading, scans, the method of ssl-vision and the whole
/// step, each on up to `most` pictures of the set in turn; an even number becomes the odd one below. Errors of files
/// and configurations.
Result<void> add_real_pictures(BenchmarkCases& cases, const std::string& filter, std::size_t most);

}  // namespace touchline::testing
