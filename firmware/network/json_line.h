#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "firmware/network/messages.h"
#include "firmware/report/trace_json.h"

namespace touchline::network {

/// Version of the live line's format (docs/network.md). It increases when a member changes its meaning or disappears.
inline constexpr int kJsonSchema = 1;

/// Writes the frame as one line of JSON with line end (docs/network.md): the members of the replay's lines, Unix times,
/// commands, telemetry, and the tracks once more by color and id. `device`: name of the camera. Returns the number of
/// bytes; 0 if `out` is too small.
std::size_t write_json_line(const OutputFrame& frame, const report::TraceNames& names, std::string_view device,
                            std::span<std::byte> out);

}  // namespace touchline::network
