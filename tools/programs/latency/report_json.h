#pragma once

#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// Durations are nanoseconds.
std::string to_json(const LatencyReport& report);
/// Reads what to_json() wrote. False: `error` names the key and what is wrong with it.
bool from_json(const std::string& text, LatencyReport& report, std::string& error);

}  // namespace touchline::latency
