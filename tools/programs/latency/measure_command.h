#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/network/network_plan.h"
#include "firmware/session.h"
#include "tools/programs/latency/led_analysis.h"
#include "tools/programs/latency/planted_delay.h"

namespace touchline::latency {

/// Paths of the output files; empty: not written.
struct Outputs {
  std::string json, csv, histogram, html;
  std::string worst_folder;  // folder for pictures and results of the worst frames
};

struct MeasureOptions {
  SessionOptions session;  // its limits are set from the members below
  std::size_t frames = 10000, warm_up = 200;
  double duration_s = 0.0;   // 0: limited by `frames`
  double deadline_ms = 0.0;  // 0: the frame period
  std::size_t listed = 5;    // number of worst frames in the report
  bool worst_frames = false, load = false;
  std::optional<LedPlace> led;  // compare the LED at this position of the picture with its line
  bool noise = false;           // measure timers beside the loop
  double stop_trace_ms = 0.0;   // stop the kernel's tracing at a frame that takes longer; 0: never
  bool pace = false;            // let an arena follow the machine's clock
  PlantedDelay planted;
  // Number of clients that read the console from a process of their own; empty: the console is not served.
  std::optional<unsigned> console_clients;
  network::NetworkOptions network;  // connections that are open during the measurement
  Outputs outputs;
};

/// Runs the loop, prints the report and writes the files; returns the exit code. All files are checked before the first
/// robot can move. A signal ends the measurement early with a report of the frames so far.
int measure(MeasureOptions& options);

/// Prints a comparison of measurement B with measurement A; returns the exit code. `html`: path of an HTML page, or
/// empty.
int compare(const std::string& path_a, const std::string& path_b, const std::string& html);

}  // namespace touchline::latency
