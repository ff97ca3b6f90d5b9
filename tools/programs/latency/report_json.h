#pragma once

#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// Writes the report as JSON. Durations are in nanoseconds.
std::string to_json(const LatencyReport& report);
/// Reads a report that to_json() wrote. Returns false, with the key and the problem in `error`, if it is malformed.
bool from_json(const std::string& text, LatencyReport& report, std::string& error);

}  // namespace touchline::latency
