#pragma once

#include <ostream>
#include <string>

#include "tools/latency/measurement.h"

namespace touchline::latency {

/// A table in microseconds.
void print(const LatencyReport& report, std::ostream& out);
/// The same for programs; durations in nanoseconds.
std::string to_json(const LatencyReport& report);
/// Histogram of all spans as PNG, both axes logarithmic, the deadline as a line. False with the reason in `error`.
bool draw_histogram(const Measurement& measurement, const LatencyReport& report, const std::string& path,
                    std::string& error);

}  // namespace touchline::latency
