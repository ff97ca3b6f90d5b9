#pragma once

#include <string>

#include "hal/result.h"
#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// Writes the report as JSON. Durations are in nanoseconds.
std::string to_json(const LatencyReport& report);
/// Reads a report that to_json() wrote. kInconsistent: it is malformed; the message names the key and the problem.
Result<LatencyReport> from_json(const std::string& text);

}  // namespace touchline::latency
