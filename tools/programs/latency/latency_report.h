#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "core/types.h"
#include "tools/programs/latency/interrupts.h"
#include "tools/programs/latency/latency_samples.h"
#include "tools/programs/latency/led_analysis.h"
#include "tools/programs/latency/rare_frames.h"
#include "tools/programs/latency/thread_usage.h"
#include "tools/programs/latency/timer_noise.h"

namespace touchline::latency {

/// The time spans that are measured for each frame: the parts from capture to packet, and two sums. For kRegion to
/// kSend, only the time in which the loop's thread executed counts; the rest counts as kWaiting.
enum class Span : std::uint8_t {
  kCamera,  // from the driver's time stamp until the loop has the frame
  kRegion,
  kMarker,
  kTrack,
  kControl,
  kEncode,      // kRegion to kEncode: in the order of Stage, to the end of the packet's encoding
  kSend,        // rest of the time until the radio has accepted the packet
  kWaiting,     // time between frame and packet without a processor
  kProcessing,  // sum of all parts except kCamera
  kLatency      // sum of all parts
};
// The first eight spans are parts, which add up to kLatency.
inline constexpr std::size_t kSpanCount = 10, kPartCount = 8;
const char* describe(Span span) noexcept;

/// The times of one frame, indexed by Span.
using SpanTimes = std::array<Duration, kSpanCount>;

/// The system on which the measurement ran. Empty texts and values: the system does not provide them.
struct SystemFacts {
  std::string processor, kernel, preemption, isolated;  // isolated: list of isolated processors (isolcpus)
  std::uint64_t processors = 0;
  std::string scheduler, affinity;
  std::int64_t priority = 0, timer_slack_ns = 0, locked_kb = 0;
  std::string governor;  // governor of the loop's processor; its frequencies
  std::optional<double> min_mhz, max_mhz, begin_mhz, end_mhz;
  std::optional<double> begin_celsius, end_celsius;  // temperature of the hottest thermal zone
  std::string load;                                  // command line of the background load that was requested
  // Mean number of processors kept busy by other programs and interrupts, and mean number given to other machines by
  // the hypervisor, from the warm-up to the end.
  std::optional<double> others_busy, stolen;
  // Interrupts on the loop's processors in the same time. Empty numbers: not readable on this system.
  std::vector<InterruptCount> interrupts;
  std::optional<std::uint64_t> non_maskable, system_management;
  std::string trace;                 // when the kernel's tracing was stopped; empty: it was not stopped
  std::vector<std::string> refused;  // real-time requests and hints that the system refused, with advice

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
    visit("others_busy", self.others_busy);
    visit("stolen", self.stolen);
    visit("interrupts", self.interrupts);
    visit("non_maskable", self.non_maskable);
    visit("system_management", self.system_management);
    visit("trace", self.trace);
    visit("refused", self.refused);
  }
};

/// Number of parts in which the thread executes: kRegion to kSend.
inline constexpr std::size_t kExecutedParts = kPartCount - 2;
inline constexpr std::size_t kFirstExecuted = static_cast<std::size_t>(Span::kRegion);

/// Waits and resource usage of a frame, in addition to its times.
struct FrameWaits {
  std::array<Duration, kExecutedParts> waited{};  // waiting in kRegion to kSend; the sum is kWaiting
  // Time in which the loop was ready to run but had no processor: between the previous packet and this frame, and
  // between frame and packet.
  Duration ready_before{}, ready_during{};
  ThreadUsage usage;      // usage between frame and packet
  Duration timer_late{};  // longest delay of TimerNoise since the previous frame
};

struct WorstFrame {
  std::uint64_t number = 0;  // number of the frame, counted from 1 after the warm-up
  SpanTimes times{};
  FrameWaits waits;
};

/// A frame that was more than half a period later than usual, and the frames that were late because of it.
struct Stall {
  std::uint64_t number = 0;   // number of its first frame
  Duration excess{};          // capture to packet of the first frame, minus the median
  Span part = Span::kCamera;  // part of the first frame that exceeds its median most
  // Number of following frames that were later than usual by more than a tenth of a period.
  std::uint64_t delayed = 0;
  std::uint64_t lost = 0;  // number of frames lost before one of these frames
};

/// Histogram of durations with bins of a 20th of a decade. Durations outside the range count in the outermost bins.
class LogHistogram {
 public:
  static constexpr int kBinsPerDecade = 20, kFirstDecade = -7, kLastDecade = 1;  // range: 100 ns to 10 s
  static constexpr std::size_t kBins = std::size_t{kBinsPerDecade} * (kLastDecade - kFirstDecade);
  void add(Duration duration) { ++counts[bin_of(duration)]; }
  static std::size_t bin_of(Duration duration);
  static double lower_edge_s(std::size_t bin);
  std::array<std::uint64_t, kBins> counts{};
};

/// Traffic that clients of the console received during the measurement.
struct ConsoleTraffic {
  std::uint64_t clients = 0, states = 0, pictures = 0, bytes = 0;  // sums over all clients
  double elapsed_s = 0.0;                                          // 0: a client was disconnected, or there were none

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("clients", self.clients);
    visit("states", self.states);
    visit("pictures", self.pictures);
    visit("bytes", self.bytes);
    visit("elapsed_s", self.elapsed_s);
  }
};

/// Result of a measurement: the content of the JSON file and of all reports.
struct LatencyReport {
  static constexpr std::int64_t kFormat = 2;
  std::string source, measured_at;  // ISO 8601, UTC
  std::uint64_t frames = 0, warm_up = 0;
  double rate_hz = 0.0;               // 0: the input has no frame rate
  Duration deadline{};                // limit from capture to packet; zero: none
  std::string time;                   // how time passed in an arena; empty without an arena
  std::string planted;                // delay that was planted on purpose; empty: none
  std::string saved;                  // command that replays the saved worst frames; empty: none were saved
  std::uint64_t deadline_misses = 0;  // by delivered and by lost frames together
  std::uint64_t period_overruns = 0;  // frames that took longer than a period from frame to packet
  std::uint64_t lost = 0;             // frames missing in the driver's sequence numbers
  std::uint64_t stall_count = 0, stall_delayed = 0, stall_lost = 0;  // sums over all stalls
  std::uint64_t overloads = 0;
  std::array<LatencySummary, kSpanCount> spans{};
  std::array<LogHistogram, kSpanCount> histograms{};
  std::vector<WorstFrame> worst;        // the frames with the longest kLatency, longest first
  std::vector<Stall> stalls;            // the longest stalls, longest first
  std::vector<RareFrames> rare_frames;  // one each for kLatency and kProcessing
  // Cost of reading the processor time, kReadings per frame; zero: not measured.
  Duration reading_cost{};
  ThreadUsage usage;  // usage of the loop's thread after the warm-up
  // Allocations of the loop's thread after the warm-up; empty in builds with a sanitizer.
  std::optional<std::uint64_t> allocations;
  std::optional<NoiseReport> noise;       // timers of a thread beside the loop; empty: not measured
  std::optional<LedReport> led;           // empty: no LED was watched
  std::optional<ConsoleTraffic> console;  // empty: the console was not served
  SystemFacts system;
};

/// Returns the part of `times` that exceeds its median most.
Span most_delayed_span(const LatencyReport& report, const SpanTimes& times);
/// Returns the executed part in which the frame waited longest.
Span longest_wait(const FrameWaits& waits);
/// Describes the worst frame, its most delayed part and the missed deadlines in one sentence. `report.worst` must not
/// be empty.
std::string summary_sentence(const LatencyReport& report);
/// Formats a duration with three significant digits and a unit: "1.86 ms".
std::string text_of(Duration duration);

}  // namespace touchline::latency
