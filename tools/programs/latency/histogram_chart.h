#pragma once

#include <span>
#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

struct NamedReport {
  std::string name;
  const LatencyReport& report;
};

// Both axes logarithmic, for paper: dark on white. One report: the whole frame above, its parts below, and the
// deadline. Several: their whole frames, one over the other.
std::string histogram_svg(std::span<const NamedReport> reports);
std::string histogram_png(std::span<const NamedReport> reports);

}  // namespace touchline::latency
