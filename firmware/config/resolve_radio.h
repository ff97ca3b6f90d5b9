#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/pipeline.h"
#include "firmware/config/locations.h"
#include "firmware/config/team_file.h"
#include "hal/result.h"

namespace touchline::config {

/// Fills the layouts of command packets and telemetry from the team file's [radio]. kInconsistent: fields contradict
/// each other, a number has no unit that its robots' data give, or packets are too large; the message has a line for
/// each. An error in a preset names its file.
Result<void> resolve_radio(const TeamFile& team, const Locations& where, PipelineParameters& out);

/// Reads the address of a robot's radio module: a number ("81", "0x35D0"), six or eight hexadecimal bytes
/// ("24:6F:28:AA:0B:01"), or an IPv4 address with or without a port. Nothing: it is none of these.
std::optional<std::uint64_t> radio_address(std::string_view text);

}  // namespace touchline::config
