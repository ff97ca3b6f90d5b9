#include "tools/programs/latency/latency_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace touchline::latency {

const char* describe(Span span) noexcept {
  switch (span) {
    case Span::kCamera:
      return "capture to frame";
    case Span::kRegion:
      return "color and region";
    case Span::kMarker:
      return "marker";
    case Span::kTrack:
      return "track";
    case Span::kControl:
      return "control";
    case Span::kEncode:
      return "encode";
    case Span::kSend:
      return "send";
    case Span::kProcessing:
      return "frame to packet";
    case Span::kLatency:
      return "capture to packet";
  }
  return "";
}

ThreadUsage ThreadUsage::of_this_thread() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt),
          static_cast<std::uint64_t>(usage.ru_nvcsw), static_cast<std::uint64_t>(usage.ru_nivcsw)};
}

ThreadUsage ThreadUsage::since(const ThreadUsage& before) const {
  return {minor_faults - before.minor_faults, major_faults - before.major_faults,
          voluntary_switches - before.voluntary_switches, involuntary_switches - before.involuntary_switches};
}

std::size_t LogHistogram::bin_of(Duration duration) {
  if (duration <= Duration::zero()) return 0;
  const double bin = (std::log10(seconds(duration)) - kFirstDecade) * kBinsPerDecade;
  return static_cast<std::size_t>(std::clamp(bin + 1e-9, 0.0, static_cast<double>(kBins - 1)));
}

double LogHistogram::lower_edge_s(std::size_t bin) {
  return std::pow(10.0, kFirstDecade + static_cast<double>(bin) / kBinsPerDecade);
}

Span most_delayed_span(const LatencyReport& report, const WorstFrame& frame) {
  std::size_t found = 0;
  const auto excess = [&](std::size_t i) { return frame.times[i] - report.spans[i].p50; };
  for (std::size_t i = 1; i < kPartCount; ++i) {
    const bool more = excess(i) > excess(found);
    // With a single frame, all parts equal their medians; then the longest part wins.
    if (more || (excess(i) == excess(found) && frame.times[i] > frame.times[found])) found = i;
  }
  return static_cast<Span>(found);
}

std::string text_of(Duration duration) {
  char text[32];
  const double s = seconds(duration);
  // %.3g would print 999.5 as 1e+03.
  const bool micro = s < 0.99e-4, milli = s < 0.9995;
  std::snprintf(text, sizeof text, "%.3g %s", s * (micro ? 1e6 : milli ? 1e3 : 1.0), micro ? "µs" : milli ? "ms" : "s");
  return text;
}

std::string summary_sentence(const LatencyReport& report) {
  const WorstFrame& frame = report.worst.front();
  const Span part = most_delayed_span(report, frame);
  const auto index = static_cast<std::size_t>(part);
  std::string text = "Worst frame: number " + std::to_string(frame.number) + " took " +
                     text_of(frame.times[static_cast<std::size_t>(Span::kLatency)]) + " from capture to packet, " +
                     text_of(frame.times[index]) + " of it in " + describe(part) + " (usually " +
                     text_of(report.spans[index].p50) + ")";
  if (report.deadline > Duration::zero()) {
    text += "; the deadline of " + text_of(report.deadline) + " was missed by " +
            std::to_string(report.deadline_misses) + " of " + std::to_string(report.frames) + " frames";
  }
  return text + ".";
}

}  // namespace touchline::latency
