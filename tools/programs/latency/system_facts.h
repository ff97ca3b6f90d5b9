#pragma once

#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// Reads the properties of the calling thread, its processor and the machine from the kernel. `root`: prefix of the
/// kernel's file paths, for tests. Do not call it while the loop runs: reading a frequency interrupts its processor.
SystemFacts read_system_facts(const std::string& root = "");
/// Reads frequency and temperature again at the end of the measurement.
void read_final_facts(SystemFacts& facts, const std::string& root = "");

}  // namespace touchline::latency
