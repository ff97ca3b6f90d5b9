#include <cmath>
#include <cstdio>
#include <limits>

#include "tools/programs/latency/report_content.h"
#include "tools/programs/latency/report_values.h"

namespace touchline::latency {
namespace {

std::string ratio_text(double ratio) {
  if (std::isinf(ratio)) return "from 0";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", ratio < 10.0 ? 2 : ratio < 100.0 ? 1 : 0, ratio);
  return text;
}

struct Column {
  const char* name;
  Duration LatencySummary::*value;
  // Nullptr: the value belongs to a single frame and has no interval.
  std::optional<TimeInterval> LatencySummary::*interval;
};
constexpr Column kColumns[] = {{"p50", &LatencySummary::p50, &LatencySummary::p50_interval},
                               {"p99", &LatencySummary::p99, &LatencySummary::p99_interval},
                               {"p99.9", &LatencySummary::p99_9, &LatencySummary::p99_9_interval},
                               {"max", &LatencySummary::max, nullptr}};

// Ratio B / A with its 95 % confidence interval, computed from the intervals of both logarithms (method of variance
// estimates recovery; Zou and Donner 2008).
struct Ratio {
  double value = 1.0, logarithm = 0.0;
  struct Distances {
    double below = 0.0, above = 0.0;  // distances from the logarithm to the ends of its interval
  };
  std::optional<Distances> interval;
  bool is_shown = false;   // `value` lies in the interval, so the interval can be shown
  bool is_judged = false;  // the times differ by enough to be judged

  // Three percentiles of ten spans are judged at once. For a 5 % risk that any of 30 ratios counts as changed by
  // chance, each interval must have 99.8 % (Bonferroni), which is 3.1 instead of 1.96 standard deviations.
  static constexpr double kWiden = 3.14 / 1.96;
  [[nodiscard]] bool grew() const { return is_judged && interval && logarithm > kWiden * interval->below; }
  [[nodiscard]] bool shrank() const { return is_judged && interval && -logarithm > kWiden * interval->above; }
};

Ratio ratio_of(const LatencySummary& a, const LatencySummary& b, const Column& column) {
  // Shorter differences are not judged: they are within the time of reading the clocks, and nobody would notice them.
  static constexpr Duration kMin = std::chrono::microseconds(1);
  const auto log_of = [](Duration time) { return std::log(std::max(seconds(kMin), seconds(time))); };
  const Duration from = a.*column.value, to = b.*column.value;
  Ratio ratio;
  ratio.value = from > Duration::zero() ? seconds(to) / seconds(from)
                : to > from             ? std::numeric_limits<double>::infinity()
                                        : 1.0;
  if (column.interval == nullptr || !(a.*column.interval) || !(b.*column.interval)) return ratio;
  const TimeInterval &in_a = *(a.*column.interval), &in_b = *(b.*column.interval);
  const double x = log_of(from), y = log_of(to);
  ratio.logarithm = y - x;
  ratio.is_shown = from >= kMin && to >= kMin;
  ratio.is_judged = std::chrono::abs(to - from) >= kMin;
  ratio.interval = {std::hypot(y - log_of(in_b.low), log_of(in_a.high) - x),
                    std::hypot(log_of(in_b.high) - y, x - log_of(in_a.low))};
  return ratio;
}

std::string interval_text(const Ratio& ratio) {
  if (!ratio.interval || !ratio.is_shown) return "";
  return ratio_text(std::exp(ratio.logarithm - ratio.interval->below)) + " to " +
         ratio_text(std::exp(ratio.logarithm + ratio.interval->above));
}

// Returns whether the count in B is higher by more than chance: counts of independent events differ by less with 97.5 %
// probability (square roots of Poisson counts have the standard deviation 1/2; Anscombe 1948).
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
