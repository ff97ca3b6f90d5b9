#pragma once

#include <span>
#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

struct NamedReport {
  std::string name;
  const LatencyReport& report;
};

/// Draws the latency histograms with logarithmic axes, dark on white. For one report: the sums in the upper panel with
/// the deadline, the parts in the lower panel. For several reports: frame to packet in the upper panel, capture to
/// packet in the lower panel, all reports overlaid.
std::string histogram_svg(std::span<const NamedReport> reports);
std::string histogram_png(std::span<const NamedReport> reports);

}  // namespace touchline::latency
