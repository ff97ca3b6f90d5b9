#pragma once

#include <cstdint>

#include "tools/programs/control/drill.h"

namespace touchline::control_evaluation {

struct BallResult {
  int runs = 0;
  double met = 0.0;            // share of the balls that were hit towards the opponent's half with 0.5 m/s or more
  double in_time = 0.0;        // share that was met at most 0.5 s after the oracle
  double median_late_s = 0.0;  // behind the oracle, of the balls that were met
};

/// Lets a ball roll at 1 m/s from a random place in a random direction; one robot stands at a random pose. The oracle
/// knows the ball's way, walls included, and drives under the same limits.
Result<BallResult> ball_drill(const config::Configuration& configuration, int runs, std::uint64_t seed);

}  // namespace touchline::control_evaluation
