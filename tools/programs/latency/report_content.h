#pragma once

#include "tools/programs/latency/histogram_chart.h"
#include "tools/programs/latency/latency_report.h"
#include "tools/programs/latency/report_rendering.h"

namespace touchline::latency {

/// Returns the report of one measurement: spans, worst frames with the most delayed part marked, counts, conditions.
/// `report.worst` must not be empty.
Document document_of(const LatencyReport& report);

/// Compares measurement `b` with `a`. A percentile counts as worse, and is marked, if its ratio is above 1 by more than
/// chance (5 % risk for all percentiles together). A count is worse if it grew by more than counts of independent
/// events vary. Maxima are listed but not judged.
Document comparison_of(const NamedReport& a, const NamedReport& b);

}  // namespace touchline::latency
