#include "tools/programs/latency/report_content.h"

#include <algorithm>
#include <cstdio>
#include <tuple>
#include <utility>

#include "tools/programs/latency/execution_meter.h"
#include "tools/programs/latency/report_values.h"

namespace touchline::latency {
namespace {

std::string begin_and_end(const std::optional<double>& begin, const std::optional<double>& end, const char* unit) {
  if (!begin && !end) return "";
  return (begin ? number(*begin) : "?") + unit + " at the start, " + (end ? number(*end) : "?") + unit + " at the end";
}

std::string interrupt_text(const SystemFacts& system) {
  constexpr std::size_t kListed = 5;
  std::uint64_t sum = 0;
  std::string text;
  for (std::size_t i = 0; i < system.interrupts.size(); ++i) {
    sum += system.interrupts[i].count;
    if (i < kListed) text += ", " + count(system.interrupts[i].count) + " x " + system.interrupts[i].name;
  }
  return system.interrupts.empty() ? "" : count(sum) + " on the loop's processors:" + text.substr(1);
}

std::string noise_text(const NoiseReport& noise) {
  return "late by p50 " + text_of(noise.p50) + ", p99 " + text_of(noise.p99) + ", p99.9 " + text_of(noise.p99_9) +
         ", max " + text_of(noise.max) + " (" + count(noise.count) + " periods of " + text_of(TimerNoise::kPeriod) +
         ", " + noise.thread + ")";
}

std::string traffic_text(const ConsoleTraffic& traffic) {
  if (traffic.elapsed_s <= 0.0) return traffic.clients > 0 ? "no result: a client was disconnected" : "";
  const auto each = [&](std::uint64_t received) {
    return number(static_cast<double>(received) / (static_cast<double>(traffic.clients) * traffic.elapsed_s));
  };
  return "each received " + each(traffic.states) + " states and " + each(traffic.pictures) + " pictures a second, " +
         each(traffic.bytes / 1000) + " kB/s";
}

Table span_table(const LatencyReport& report) {
  Table table{"Milliseconds, " + count(report.frames) + " frames", {"", "p50", "p90", "p99", "p99.9", "max"}, {}};
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    const LatencySummary& s = report.spans[i];
    auto& row = table.rows.emplace_back();
    row.push_back({describe(static_cast<Span>(i))});
    for (const Duration d : {s.p50, s.p90, s.p99, s.p99_9, s.max}) row.push_back({milliseconds(d)});
  }
  return table;
}

Table worst_table(const LatencyReport& report) {
  Table table{"Worst frames, milliseconds; marked: the part farthest above its median", {"", "usually"}, {}};
  for (const WorstFrame& frame : report.worst) table.head.push_back("#" + count(frame.number));
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    auto& row = table.rows.emplace_back();
    row.push_back({describe(static_cast<Span>(i))});
    row.push_back({milliseconds(report.spans[i].p50)});
    for (const WorstFrame& frame : report.worst) {
      row.push_back({milliseconds(frame.times[i]), most_delayed_span(report, frame.times) == static_cast<Span>(i)});
    }
  }
  const auto add_row = [&](const char* name, const auto& value_of) {
    auto& row = table.rows.emplace_back();
    row.push_back({name});
    row.push_back({""});
    for (const WorstFrame& frame : report.worst) row.push_back({value_of(frame.waits)});
  };
  add_row("ready, no processor", [](const FrameWaits& w) { return milliseconds(w.ready_before + w.ready_during); });
  add_row("waits + preemptions", [](const FrameWaits& w) {
    return count(w.usage.voluntary_switches) + " + " + count(w.usage.involuntary_switches);
  });
  if (report.noise) add_row("a timer was late by", [](const FrameWaits& w) { return milliseconds(w.timer_late); });
  add_row("page faults", [](const FrameWaits& w) { return count(w.usage.minor_faults + w.usage.major_faults); });
  return table;
}

// Lists the parts in which the worst frames waited; no rows if none of them waited noticeably.
Table waiting_table(const LatencyReport& report) {
  constexpr Duration kNoticeable = std::chrono::microseconds(50);
  Table table{"Where worst frames executed + waited, milliseconds", {""}, {}};
  for (std::size_t i = 0; i < kExecutedParts; ++i)
    table.rows.push_back({{describe(static_cast<Span>(kFirstExecuted + i))}});
  for (const WorstFrame& frame : report.worst) {
    if (frame.times[static_cast<std::size_t>(Span::kWaiting)] < kNoticeable) continue;
    table.head.push_back("#" + count(frame.number));
    const auto longest = static_cast<std::size_t>(longest_wait(frame.waits)) - kFirstExecuted;
    for (std::size_t i = 0; i < kExecutedParts; ++i) {
      table.rows[i].push_back(
          {milliseconds(frame.times[kFirstExecuted + i]) + " + " + milliseconds(frame.waits.waited[i]), i == longest});
    }
  }
  if (table.head.size() == 1) table.rows.clear();
  return table;
}

// Returns text such as "1 in 2300000 frames".
std::string one_in_text(double share) {
  constexpr double kNever = 1e-12;
  if (share < kNever) return "never";
  char text[48];
  std::snprintf(text, sizeof text, "1 in %.3g frames", 1.0 / share);
  return text;
}

Table rare_table(const LatencyReport& report) {
  Table table{"Rare frames, estimated from the slowest ones", {"", "slower than", "95 % interval"}, {}};
  for (const RareFrames& rare : report.rare_frames) {
    for (const RareTime& time : rare.times) {
      table.rows.push_back({{rare.span + ", 1 in " + count(time.one_in)},
                            {text_of(time.time)},
                            {text_of(time.low) + " to " + (time.high ? text_of(*time.high) : "no limit")}});
    }
    if (!rare.misses || !rare.refusal.empty()) continue;
    table.rows.push_back({{"deadline of " + text_of(report.deadline) + " missed"},
                          {one_in_text(rare.misses->share)},
                          {one_in_text(rare.misses->high) + " to " + one_in_text(rare.misses->low)}});
  }
  return table;
}

std::string rare_text(const RareFrames& rare) {
  char text[160];
  std::snprintf(text, sizeof text,
                "from the slowest %llu (above %s), shape %.2f; independence p %.3f, stationarity p %.3f, fit p %.3f",
                static_cast<unsigned long long>(rare.peaks), text_of(rare.threshold).c_str(), rare.shape,
                rare.independence, rare.stationarity, rare.fit);
  if (rare.refusal.empty()) return text;
  return "no estimate: " + rare.refusal + (rare.peaks > 0 ? "; " + std::string(text) : "");
}

Table led_table(const LedReport& led) {
  Table table{
      "Light to packet, milliseconds, " + count(led.edges) + " edges of the LED", {"", "p50", "p90", "p99", "max"}, {}};
  const auto add_row = [&table](const char* name, const LatencySummary& s) {
    auto& row = table.rows.emplace_back();
    row.push_back({name});
    for (const Duration d : {s.p50, s.p90, s.p99, s.max}) row.push_back({milliseconds(d)});
  };
  add_row("LED to packet", led.light_to_packet);
  add_row("capture to packet", led.capture_to_packet);
  return table;
}

std::string led_text(const LedReport& led) {
  std::string text = "brightness " + number(led.off_level) + " when off, " + number(led.on_level) + " when on; " +
                     count(led.partial) + " edges within an exposure";
  if (led.uncertain > 0)
    text += "; not used, because their time is uncertain: " + count(led.uncertain) +
            (led.uncertain == 1 ? " edge" : " edges");
  return text;
}

std::string stamp_text(const LedReport& led) {
  if (!led.stamp_error) return "";
  const bool late = *led.stamp_error >= Duration::zero();
  return text_of(late ? *led.stamp_error : -*led.stamp_error) + (late ? " later" : " earlier") +
         " than the middle of the exposure, +- " + text_of(led.stamp_resolution);
}

Table stall_table(const LatencyReport& report) {
  Table table{"Stalls: frames more than half a period later than usual, and the frames that they delayed or lost",
              {"", "later by, ms", "because of", "delayed", "lost"},
              {}};
  for (const Stall& stall : report.stalls) {
    table.rows.push_back({{"#" + count(stall.number)},
                          {milliseconds(stall.excess)},
                          {describe(stall.part)},
                          {count(stall.delayed)},
                          {count(stall.lost)}});
  }
  return table;
}

}  // namespace

Document document_of(const LatencyReport& report) {
  Document document{
      "Frame latency: " + report.source, summary_sentence(report), {span_table(report), worst_table(report)}, {}};
  for (Table table : {waiting_table(report), stall_table(report), rare_table(report)}) {
    if (!table.rows.empty()) document.tables.push_back(std::move(table));
  }
  if (report.led && report.led->refusal.empty()) document.tables.push_back(led_table(*report.led));
  Facts& facts = document.facts;
  if (report.led) {
    add(facts, "LED", report.led->refusal.empty() ? led_text(*report.led) : "no result: " + report.led->refusal);
    add(facts, "driver's time stamp", stamp_text(*report.led));
  }
  for (const Counted& counted : counts_of(report)) add(facts, counted.name, text_of_count(counted));
  for (auto& condition : conditions_of(report)) facts.push_back(std::move(condition));
  add(facts, "other programs", measured_load(report.system));
  for (const RareFrames& rare : report.rare_frames) {
    facts.emplace_back("rare frames, " + rare.span, rare_text(rare));
  }
  add(facts, "interrupts", interrupt_text(report.system));
  if (!report.system.interrupts.empty()) {
    const auto& [nmi, smi] = std::tie(report.system.non_maskable, report.system.system_management);
    add(facts, "non-maskable", nmi ? count(*nmi) + " interrupts" : "not counted here");
    add(facts, "system management",
        smi ? count(*smi) + " interrupts" : "not readable here (Intel only, as root with the module msr)");
  }
  if (report.noise) add(facts, "timer beside the loop", noise_text(*report.noise));
  if (report.console) add(facts, "console's clients", traffic_text(*report.console));
  add(facts, "kernel's trace", report.system.trace);
  add(facts, "frequency", begin_and_end(report.system.begin_mhz, report.system.end_mhz, " MHz"));
  add(facts, "temperature", begin_and_end(report.system.begin_celsius, report.system.end_celsius, " °C"));
  if (report.reading_cost > Duration::zero()) {
    add(facts, "cost of measuring",
        count(ExecutionMeter::kReadings) + " readings of the processor time per frame, " +
            text_of(report.reading_cost) + " each");
  }
  for (const std::string& refused : report.system.refused) add(facts, "real time", refused);
  add(facts, "replay the worst", report.saved);
  add(facts, "measured", report.measured_at + ", after " + count(report.warm_up) + " frames of warm-up");
  return document;
}

}  // namespace touchline::latency
