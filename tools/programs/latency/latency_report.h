#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "core/types.h"
#include "tools/programs/latency/latency_samples.h"

namespace touchline::latency {

/// What is measured: where a frame is from its capture to its packet, and the frame as a whole.
enum class Span : std::uint8_t {
  kCamera,  // the driver's stamp until the loop has the frame
  kRegion,
  kMarker,
  kTrack,
  kControl,
  kEncode,      // Stage, in its order
  kSend,        // the rest until the radio has taken the packet
  kProcessing,  // all but kCamera
  kLatency      // all
};
inline constexpr std::size_t kSpanCount = 9, kPartCount = 7;  // the first seven add up to the last
const char* describe(Span span) noexcept;

/// One frame, by Span.
using SpanTimes = std::array<Duration, kSpanCount>;

/// Kernel's account of a thread.
struct ThreadUsage {
  std::uint64_t minor_faults = 0, major_faults = 0;
  std::uint64_t voluntary_switches = 0, involuntary_switches = 0;  // it waited; it was displaced
  static ThreadUsage of_this_thread();
  ThreadUsage since(const ThreadUsage& before) const;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("minor_faults", self.minor_faults);
    visit("major_faults", self.major_faults);
    visit("voluntary_switches", self.voluntary_switches);
    visit("involuntary_switches", self.involuntary_switches);
  }
};

/// What the measurement ran on. Empty texts and values: this system does not tell.
struct SystemFacts {
  std::string processor, kernel, preemption, isolated;  // isolated: processors that others are kept away from
  std::uint64_t processors = 0;
  std::string scheduler, affinity;
  std::int64_t priority = 0, timer_slack_ns = 0, locked_kb = 0;
  std::string governor;  // of the loop's processor, as the frequencies
  std::optional<double> min_mhz, max_mhz, begin_mhz, end_mhz;
  std::optional<double> begin_celsius, end_celsius;  // of the hottest zone
  std::string load;                                  // what ran beside it
  std::vector<std::string> refused;                  // real-time requests and hints, with what to do

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("processor", self.processor);
    visit("processors", self.processors);
    visit("kernel", self.kernel);
    visit("preemption", self.preemption);
    visit("isolated", self.isolated);
    visit("scheduler", self.scheduler);
    visit("priority", self.priority);
    visit("affinity", self.affinity);
    visit("timer_slack_ns", self.timer_slack_ns);
    visit("locked_kb", self.locked_kb);
    visit("governor", self.governor);
    visit("min_mhz", self.min_mhz);
    visit("max_mhz", self.max_mhz);
    visit("begin_mhz", self.begin_mhz);
    visit("end_mhz", self.end_mhz);
    visit("begin_celsius", self.begin_celsius);
    visit("end_celsius", self.end_celsius);
    visit("load", self.load);
    visit("refused", self.refused);
  }
};

struct WorstFrame {
  std::uint64_t number = 0;  // from 1, after the warm-up
  SpanTimes times{};
};

/// Counts of durations in bins that are a 20th of a decade wide; the outermost ones hold what lies beyond.
class LogHistogram {
 public:
  static constexpr int kBinsPerDecade = 20, kFirstDecade = -7, kLastDecade = 1;  // 100 ns to 10 s
  static constexpr std::size_t kBins = std::size_t{kBinsPerDecade} * (kLastDecade - kFirstDecade);
  void add(Duration duration) { ++counts[bin_of(duration)]; }
  static std::size_t bin_of(Duration duration);
  static double lower_edge_s(std::size_t bin);
  std::array<std::uint64_t, kBins> counts{};
};

/// Everything that output needs; what the JSON file holds.
struct LatencyReport {
  static constexpr std::int64_t kFormat = 1;
  std::string source, measured_at;  // ISO 8601, UTC
  std::uint64_t frames = 0, warm_up = 0;
  double rate_hz = 0.0;  // 0: the input has none
  Duration deadline{};   // from capture to packet; zero: none
  std::uint64_t deadline_misses = 0;
  std::uint64_t period_overruns = 0;  // frames that took longer than a period from frame to packet
  std::uint64_t lost = 0;             // gaps in the driver's count
  std::uint64_t overloads = 0;
  std::array<LatencySummary, kSpanCount> spans{};
  std::array<LogHistogram, kSpanCount> histograms{};
  std::vector<WorstFrame> worst;             // by kLatency, longest first
  ThreadUsage usage;                         // of the loop's thread after warm-up
  std::optional<std::uint64_t> allocations;  // likewise; nothing: built with a sanitizer, whose allocator is its own
  SystemFacts system;
};

/// The part of `frame` that lay farthest above its median.
Span culprit(const LatencyReport& report, const WorstFrame& frame);
/// One sentence: the worst frame, the stage it sat in, the deadline. `report.worst` must not be empty.
std::string verdict(const LatencyReport& report);
/// Three digits and a unit: "1.86 ms".
std::string text_of(Duration duration);

}  // namespace touchline::latency
