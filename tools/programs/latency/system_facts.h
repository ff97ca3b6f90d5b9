#pragma once

#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// What the kernel says about the calling thread, its processor and the machine. `root` stands before the paths of its
/// files: empty, except in tests. The loop must not run meanwhile: reading a frequency interrupts its processor.
SystemFacts read_system_facts(const std::string& root = "");
/// Once more at the end: frequency and temperature.
void read_final_facts(SystemFacts& facts, const std::string& root = "");

}  // namespace touchline::latency
