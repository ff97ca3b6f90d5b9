#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/session.h"

namespace touchline::latency {

// Exit codes, as those of touchline.
inline constexpr int kExitOk = 0, kExitBadFile = 1, kExitDeviceFailure = 2;

struct Outputs {
  std::string json, histogram, html;  // paths; empty: none
};

struct MeasureOptions {
  SessionOptions session;  // its limits are set from these:
  std::size_t frames = 10000, warm_up = 200;
  double duration_s = 0.0;   // 0: `frames`
  double deadline_ms = 0.0;  // 0: the frame's period
  std::size_t listed = 5;    // worst frames
  bool worst_frames = false, load = false;
  Outputs outputs;
};

/// Runs the loop, prints the report and writes the files; returns the exit code. What can be refused is refused before
/// anything moves. A signal ends it early with the report so far.
int measure(const MeasureOptions& options);

/// Prints B against A. `html`: as well as a page; empty: none.
int compare(const std::string& path_a, const std::string& path_b, const std::string& html);

}  // namespace touchline::latency
