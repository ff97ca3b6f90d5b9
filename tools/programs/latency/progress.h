#pragma once

#include <cstddef>
#include <thread>

#include "tools/programs/latency/measurement.h"

namespace touchline::latency {

/// Counts steps on a person's terminal, from a thread of its own: the loop that is measured does not know. Silent when
/// standard error is no terminal.
class Progress {
 public:
  /// `steps`: as many as there will be; 0: nobody knows.
  Progress(const Measurement& measurement, std::size_t steps);

 private:
  std::jthread thread_;
};

}  // namespace touchline::latency
