#pragma once

#include <cstdint>

#include "tools/programs/control/drill.h"

namespace touchline::control_evaluation {

struct PoseResult {
  int runs = 0;
  double median = 0.0, p95 = 0.0;                           // time over the bound plus 0.15 s
  double mean_s = 0.0, bound_s = 0.0;                       // mean time, mean bound
  double arrived = 0.0;                                     // share of the runs that end within 3 mm and 1 degree
  double median_mm = 0.0, p95_mm = 0.0, p95_degrees = 0.0;  // errors at the end
};

/// Drives one robot from random poses to random poses, from rest to rest.
Result<PoseResult> pose_drill(const config::Configuration& configuration, int runs, std::uint64_t seed);

}  // namespace touchline::control_evaluation
