#pragma once

#include "tools/programs/latency/histogram_chart.h"
#include "tools/programs/latency/latency_report.h"
#include "tools/programs/latency/report_rendering.h"

namespace touchline::latency {

/// Report of one measurement: spans, worst frames with the most delayed part marked, counts, conditions. `report.worst`
/// must not be empty.
Document document_of(const LatencyReport& report);

/// Compares measurement `b` with `a`. A value counts as worse, and is marked, if a median or p99 grew by more than a
/// tenth, a maximum (noisy, because it is a single frame) by more than a quarter, in each case by more than 2 us, or if
/// a count grew relative to the number of frames.
Document comparison_of(const NamedReport& a, const NamedReport& b);

}  // namespace touchline::latency
