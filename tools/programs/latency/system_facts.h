#pragma once

#include <optional>
#include <string>

#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// Reads the properties of the calling thread, its processor and the machine from the kernel. `root` is a prefix of the
/// kernel's file paths, used by tests. Do not call it while the loop runs: reading a frequency interrupts its
/// processor.
SystemFacts read_system_facts(const std::string& root = "");
/// Reads frequency and temperature again at the end of the measurement.
void read_final_facts(SystemFacts& facts, const std::string& root = "");

/// Processor time in seconds since an arbitrary moment, of all processors together (proc(5), /proc/stat).
struct ProcessorTimes {
  double busy_s = 0.0;    // spent by all programs and interrupts
  double stolen_s = 0.0;  // spent by a hypervisor on other machines
  double own_s = 0.0;     // spent by this process, all threads
  double elapsed_s = 0.0;
};

/// Returns nothing if the kernel does not provide these times. `root` as for read_system_facts().
std::optional<ProcessorTimes> read_processor_times(const std::string& root = "");
/// Sets SystemFacts::others_busy and stolen. The kernel counts in steps of a few milliseconds, so the values stay empty
/// after less than a tenth of a second.
void add_load(SystemFacts& facts, const ProcessorTimes& begin, const ProcessorTimes& end);

}  // namespace touchline::latency
