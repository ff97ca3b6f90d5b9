#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/geometry/field_area.h"
#include "firmware/network/messages.h"
#include "firmware/report/trace_json.h"

namespace touchline::network {

/// Version of the live line's format (docs/network.md). It increases when a member changes its meaning or disappears.
inline constexpr int kJsonSchema = 1;

/// Writes the members of a line that come from a running game (docs/network.md): the tracked robots once more by color
/// and id, stops, commands, telemetry, score, side, field and referee.
void write_game_members(report::JsonWriter& json, const Snapshot& snapshot, const report::TraceNames& names,
                        const FieldParameters& field);

/// Writes the member `field`: sizes in m.
void write_field(report::JsonWriter& json, const FieldParameters& field);

/// Writes the frame as one line of JSON with line end (docs/network.md): the members of the replay's lines, Unix times,
/// and those of write_game_members(). `device`: name of the camera. Returns the number of bytes; 0 if `out` is too
/// small.
std::size_t write_json_line(const OutputFrame& frame, const report::TraceNames& names, const FieldParameters& field,
                            std::string_view device, std::span<std::byte> out);

}  // namespace touchline::network
