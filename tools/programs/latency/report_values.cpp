#include "tools/programs/latency/report_values.h"

#include <cstdio>

namespace touchline::latency {

std::string milliseconds(Duration duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", seconds(duration) * 1e3);
  return text;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string count(std::uint64_t n) { return std::to_string(n); }

std::string measured_load(const SystemFacts& system) {
  if (!system.others_busy) return "";
  const auto of_all = [&](double processors) {
    char text[64];
    std::snprintf(text, sizeof text, "%.2f of %s processors", processors, count(system.processors).c_str());
    return std::string(text);
  };
  std::string text = "kept " + of_all(*system.others_busy) + " busy";
  // Smaller values are below the resolution of the kernel's counts.
  constexpr double kNoticeable = 0.005;
  if (system.stolen.value_or(0.0) > kNoticeable) text += "; the hypervisor withheld " + of_all(*system.stolen);
  return text;
}

void add(Facts& facts, const char* name, const std::string& value) {
  if (!value.empty()) facts.emplace_back(name, value);
}

Facts conditions_of(const LatencyReport& report) {
  const SystemFacts& system = report.system;
  Facts facts;
  add(facts, "source", report.source);
  if (report.rate_hz > 0.0) add(facts, "frame rate", number(report.rate_hz) + " Hz");
  if (report.deadline > Duration::zero()) add(facts, "deadline", text_of(report.deadline));
  add(facts, "time", report.time);
  add(facts, "planted on purpose", report.planted);
  add(facts, "processors", count(system.processors) + " x " + system.processor);
  add(facts, "loop on",
      system.affinity + (system.isolated.empty() ? "; no isolated processors" : "; isolated " + system.isolated));
  add(facts, "scheduler",
      system.scheduler + ", priority " + std::to_string(system.priority) + ", timer slack " +
          std::to_string(system.timer_slack_ns) + " ns");
  add(facts, "memory", system.locked_kb > 0 ? "locked" : "not locked");
  add(facts, "governor", system.governor);
  if (system.min_mhz && system.max_mhz) {
    add(facts, "frequency range", number(*system.min_mhz) + " to " + number(*system.max_mhz) + " MHz");
  }
  add(facts, "kernel", system.kernel + ", " + system.preemption);
  if (report.console) add(facts, "console", count(report.console->clients) + " clients");
  add(facts, "background load", system.load.empty() ? "none requested" : system.load);
  return facts;
}

std::vector<Counted> counts_of(const LatencyReport& report) {
  const ThreadUsage& usage = report.usage;
  return {{"deadline missed", report.deadline_misses},
          {"frame to packet longer than a period", report.period_overruns},
          {"lost frames", report.lost},
          {"stalls", report.stall_count},
          {"frames delayed by stalls", report.stall_delayed},
          {"frames lost by stalls", report.stall_lost},
          {"frames overloaded", report.overloads},
          {"page faults (minor)", usage.minor_faults},
          {"page faults (major)", usage.major_faults},
          {"context switches (voluntary)", usage.voluntary_switches},
          {"context switches (preempted)", usage.involuntary_switches},
          {"allocations", report.allocations}};
}

std::string text_of_count(const Counted& counted) { return counted.value ? count(*counted.value) : "not counted"; }

}  // namespace touchline::latency
