#pragma once

#include "tools/programs/latency/document.h"
#include "tools/programs/latency/histogram_chart.h"
#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// One measurement: stages, worst frames with the culprit of each marked, conditions. `report.worst` must not be empty.
Document document_of(const LatencyReport& report);

/// Two measurements, the second held against the first. Worse, and marked: a median or p99 that grew by more than a
/// tenth, a maximum (one frame, so it is noisy) that grew by more than a quarter, in each case by more than 2 us; and
/// counts that grew relative to the number of frames.
Document comparison_of(const NamedReport& a, const NamedReport& b);

}  // namespace touchline::latency
