#include "tools/programs/latency/report_content.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <tuple>
#include <utility>

#include "tools/programs/latency/execution_meter.h"

namespace touchline::latency {
namespace {

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

std::string begin_and_end(const std::optional<double>& begin, const std::optional<double>& end, const char* unit) {
  if (!begin && !end) return "";
  return (begin ? number(*begin) : "?") + unit + " at the start, " + (end ? number(*end) : "?") + unit + " at the end";
}

// The load that was really there, whether requested or not.
std::string measured_load(const SystemFacts& system) {
  if (!system.others_busy) return "";
  const auto of_all = [&](double processors) {
    char text[64];
    std::snprintf(text, sizeof text, "%.2f of %s processors", processors, count(system.processors).c_str());
    return std::string(text);
  };
  std::string text = "kept " + of_all(*system.others_busy) + " busy";
  // Less is the resolution of the kernel's counts.
  constexpr double kNoticeable = 0.005;
  if (system.stolen.value_or(0.0) > kNoticeable) text += "; the hypervisor withheld " + of_all(*system.stolen);
  return text;
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

// In which parts the worst frames waited; no rows if none of them waited noticeably.
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

// "1 in 2300000 frames"
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
  if (led.uncertain > 0) text += "; " + count(led.uncertain) + " edges not used, because their time is uncertain";
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

using Facts = std::vector<std::pair<std::string, std::string>>;

void add(Facts& facts, const char* name, const std::string& value) {
  if (!value.empty()) facts.emplace_back(name, value);
}

// Settings and system properties, without measured values.
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
  add(facts, "background load", system.load.empty() ? "none requested" : system.load);
  return facts;
}

struct Counted {
  const char* name;
  std::optional<std::uint64_t> value;
};

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

std::string ratio_text(double ratio) {
  if (std::isinf(ratio)) return "from 0";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", ratio < 10.0 ? 2 : ratio < 100.0 ? 1 : 0, ratio);
  return text;
}

struct Column {
  const char* name;
  Duration LatencySummary::*value;
  std::optional<TimeInterval> LatencySummary::*interval;  // nullptr: a single frame, which has none
};
constexpr Column kColumns[] = {{"p50", &LatencySummary::p50, &LatencySummary::p50_interval},
                               {"p99", &LatencySummary::p99, &LatencySummary::p99_interval},
                               {"p99.9", &LatencySummary::p99_9, &LatencySummary::p99_9_interval},
                               {"max", &LatencySummary::max, nullptr}};

// B / A with its 95 % interval: from the intervals of both logarithms (method of variance estimates recovery; Zou and
// Donner 2008).
struct Ratio {
  double value = 1.0, logarithm = 0.0;
  struct Distances {
    double below = 0.0, above = 0.0;  // from the logarithm to the ends of its interval
  };
  std::optional<Distances> interval;

  // Three percentiles of ten spans are judged at once. For a 5 % risk that any of 30 ratios counts as changed by
  // chance, each interval must have 99.8 % (Bonferroni), which is 3.1 instead of 1.96 standard deviations.
  static constexpr double kWiden = 3.14 / 1.96;
  [[nodiscard]] bool grew() const { return interval && logarithm > kWiden * interval->below; }
  [[nodiscard]] bool shrank() const { return interval && -logarithm > kWiden * interval->above; }
};

Ratio ratio_of(const LatencySummary& a, const LatencySummary& b, const Column& column) {
  // Not below a microsecond: the times of reading the clocks, which nobody would notice.
  const auto log_of = [](Duration time) { return std::log(std::max(1e-6, seconds(time))); };
  const Duration from = a.*column.value, to = b.*column.value;
  Ratio ratio;
  ratio.value = from > Duration::zero() ? seconds(to) / seconds(from)
                : to > from             ? std::numeric_limits<double>::infinity()
                                        : 1.0;
  if (column.interval == nullptr || !(a.*column.interval) || !(b.*column.interval)) return ratio;
  const TimeInterval &in_a = *(a.*column.interval), &in_b = *(b.*column.interval);
  const double x = log_of(from), y = log_of(to);
  ratio.logarithm = y - x;
  ratio.interval = {std::hypot(y - log_of(in_b.low), log_of(in_a.high) - x),
                    std::hypot(log_of(in_b.high) - y, x - log_of(in_a.low))};
  return ratio;
}

std::string interval_text(const Ratio& ratio) {
  if (!ratio.interval) return "";
  return ratio_text(std::exp(ratio.logarithm - ratio.interval->below)) + " to " +
         ratio_text(std::exp(ratio.logarithm + ratio.interval->above));
}

// Counts of events that are independent of each other differ by less with 97.5 % probability (square roots of Poisson
// counts have the standard deviation 1/2; Anscombe 1948).
bool occurs_more_often(std::uint64_t in_a, std::uint64_t frames_a, std::uint64_t in_b, std::uint64_t frames_b) {
  constexpr double kSigmas = 1.96, kOffset = 3.0 / 8.0;
  if (frames_a == 0 || frames_b == 0) return false;
  const double longer = static_cast<double>(frames_b) / static_cast<double>(frames_a);
  const double difference =
      std::sqrt(static_cast<double>(in_b) + kOffset) - std::sqrt((static_cast<double>(in_a) + kOffset) * longer);
  return difference > 0.5 * kSigmas * std::sqrt(1.0 + longer);
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text;
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

Document comparison_of(const NamedReport& a, const NamedReport& b) {
  Document document{"Frame latency: " + b.name + " against " + a.name, "", {}, {}};
  std::vector<std::string> worse, better, more;
  bool is_judged = true;
  for (const Column& column : kColumns) {
    document.tables.push_back({std::string(column.name) + ", milliseconds", {"", "A", "B", "B / A", "95 %"}, {}});
  }
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    const std::string name = describe(static_cast<Span>(i));
    std::vector<std::string> grown, shrunk;
    for (std::size_t k = 0; k < std::size(kColumns); ++k) {
      const Column& column = kColumns[k];
      const LatencySummary &in_a = a.report.spans[i], &in_b = b.report.spans[i];
      const Ratio ratio = ratio_of(in_a, in_b, column);
      const std::string value = ratio_text(ratio.value);
      document.tables[k].rows.push_back({{name},
                                         {milliseconds(in_a.*column.value)},
                                         {milliseconds(in_b.*column.value)},
                                         {value, ratio.grew()},
                                         {interval_text(ratio)}});
      is_judged = is_judged && (ratio.interval || column.value != &LatencySummary::p50);
      if (!ratio.grew() && !ratio.shrank()) continue;
      (ratio.grew() ? grown : shrunk)
          .push_back(std::string(column.name) + (std::isinf(ratio.value) ? " " : " x ") + value);
    }
    // Lists capture to packet first, then the parts.
    const auto note = [&](std::vector<std::string>& list, const std::vector<std::string>& changes) {
      const bool whole = static_cast<Span>(i) == Span::kLatency;
      if (!changes.empty()) list.insert(whole ? list.begin() : list.end(), name + " (" + listed(changes) + ")");
    };
    note(worse, grown);
    note(better, shrunk);
  }
  Table& counts = document.tables.emplace_back(Table{"Counts", {"", "A", "B"}, {}});
  counts.rows.push_back({{"frames"}, {count(a.report.frames)}, {count(b.report.frames)}});
  const std::vector<Counted> before = counts_of(a.report), after = counts_of(b.report);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool grew = before[i].value &&
                      occurs_more_often(*before[i].value, a.report.frames, after[i].value.value_or(0), b.report.frames);
    if (grew) more.emplace_back(before[i].name);
    counts.rows.push_back({{before[i].name}, {text_of_count(before[i])}, {text_of_count(after[i]), grew}});
  }
  const Facts of_a = conditions_of(a.report), of_b = conditions_of(b.report);
  const auto value_in = [](const Facts& facts, const std::string& name) {
    for (const auto& [other, value] : facts) {
      if (other == name) return value;
    }
    return std::string("unknown");
  };
  const auto differs = [&document](std::string name, const std::string& in_a, const std::string& in_b) {
    name += " differs";
    std::string values = "A ";
    values.append(in_a).append("; B ").append(in_b);
    document.facts.emplace_back(std::move(name), std::move(values));
  };
  add(document.facts, "A", a.name + ", " + a.report.source + ", " + a.report.measured_at);
  add(document.facts, "B", b.name + ", " + b.report.source + ", " + b.report.measured_at);
  for (const auto& [name, value] : of_a) {
    const std::string other = value_in(of_b, name);
    if (other != value) differs(name, value, other);
  }
  for (const auto& [name, value] : of_b) {
    if (value_in(of_a, name) == "unknown") differs(name, "unknown", value);
  }
  const std::string load_a = measured_load(a.report.system), load_b = measured_load(b.report.system);
  add(document.facts, "other programs in A", load_a);
  add(document.facts, "other programs in B", load_b);
  document.summary = !is_judged      ? "Too few frames to judge times; at least 200 are needed"
                     : worse.empty() ? "No time got worse from A to B"
                                     : "Worse in B: " + listed(worse);
  if (!more.empty()) document.summary += "; more often in B: " + listed(more);
  if (!better.empty()) document.summary += "; better in B: " + listed(better);
  document.summary += ".";
  return document;
}

}  // namespace touchline::latency
