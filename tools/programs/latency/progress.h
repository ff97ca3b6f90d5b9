#pragma once

#include <cstddef>
#include <thread>

#include "tools/programs/latency/measurement.h"

namespace touchline::latency {

/// Shows the number of steps on the terminal from a thread of its own, so that the measured loop is not affected. Does
/// nothing if standard error is not a terminal.
class Progress {
 public:
  /// `steps`: total number of steps; 0: unknown.
  Progress(const Measurement& measurement, std::size_t steps);

 private:
  std::jthread thread_;
};

}  // namespace touchline::latency
