#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace touchline::report {

/// What people call the colors and teams.
struct TraceNames {
  std::vector<std::string> colors;   // indexed by ColorId; 0: background
  std::array<std::string, 2> teams;  // indexed by Team: the color of its team patches
};

/// What a frame led to, as one line of JSON without line end (docs/replay.md): what it alone shows (`sightings`) and
/// the filtered state at its capture time (`tracks`). Meters, radians, seconds; rounded to 0.01 mm, 0.00001 rad, 0.1
/// mm/s, 0.001 pixel. Unknown ids and headings are null. `frame`: its number in the input from 0; `file`: where it
/// stands, or the device.
std::string trace_line(const StepTrace& trace, const TraceNames& names, std::uint64_t frame, std::string_view file);

}  // namespace touchline::report
