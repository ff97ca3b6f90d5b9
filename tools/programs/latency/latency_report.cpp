#include "tools/programs/latency/latency_report.h"

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
    case Span::kWaiting:
      return "waiting";
    case Span::kProcessing:
      return "frame to packet";
    case Span::kLatency:
      return "capture to packet";
  }
  return "";
}

std::size_t LogHistogram::bin_of(Duration duration) {
  if (duration <= Duration::zero()) return 0;
  const double bin = (std::log10(seconds(duration)) - kFirstDecade) * kBinsPerDecade;
  return static_cast<std::size_t>(std::clamp(bin + 1e-9, 0.0, static_cast<double>(kBins - 1)));
}

double LogHistogram::lower_edge_s(std::size_t bin) {
  return std::pow(10.0, kFirstDecade + static_cast<double>(bin) / kBinsPerDecade);
}

Span most_delayed_span(const LatencyReport& report, const SpanTimes& times) {
  std::size_t found = 0;
  const auto excess = [&](std::size_t i) { return times[i] - report.spans[i].p50; };
  for (std::size_t i = 1; i < kPartCount; ++i) {
    const bool more = excess(i) > excess(found);
    // With a single frame, all parts equal their medians; then the longest part is chosen.
    if (more || (excess(i) == excess(found) && times[i] > times[found])) found = i;
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

Span longest_wait(const FrameWaits& waits) {
  const auto longest = std::max_element(waits.waited.begin(), waits.waited.end());
  return static_cast<Span>(kFirstExecuted + static_cast<std::size_t>(longest - waits.waited.begin()));
}

namespace {

// Returns further facts about the most delayed part, such as "marker executed 0.2 ms and waited 12 ms".
std::string explanation(const LatencyReport& report, const WorstFrame& frame, Span part) {
  const auto index = static_cast<std::size_t>(part);
  const Duration excess = frame.times[index] - report.spans[index].p50;
  const auto without_processor = [](Duration time) {
    return "the loop was ready to run, but had no processor for " + text_of(time);
  };
  if (part == Span::kCamera) {
    return 2 * frame.waits.ready_before > excess && excess > Duration::zero()
               // In the arena, rendering also waits, and this waiting is in no span.
               ? ": " + without_processor(std::min(frame.waits.ready_before, frame.times[index]))
               : "";
  }
  if (part != Span::kWaiting) return "";
  const auto where = static_cast<std::size_t>(longest_wait(frame.waits));
  const bool machine = 2 * frame.waits.timer_late > excess;
  std::string text = std::string(": ") + describe(static_cast<Span>(where)) + " executed " +
                     text_of(frame.times[where]) + " and waited " + text_of(frame.waits.waited[where - kFirstExecuted]);
  if (machine) {
    text += "; a timer beside the loop was late by " + text_of(frame.waits.timer_late) +
            ", so the machine caused the delay";
  }
  if (2 * frame.waits.ready_during > excess) return text + "; " + without_processor(frame.waits.ready_during);
  if (frame.waits.usage.major_faults > 0) return text + "; it read pages from a disk";
  return text + (machine ? "" : "; it was blocked or stopped");
}

}  // namespace

std::string summary_sentence(const LatencyReport& report) {
  const WorstFrame& frame = report.worst.front();
  const Span part = most_delayed_span(report, frame.times);
  const auto index = static_cast<std::size_t>(part);
  std::string text = "Worst frame: number " + std::to_string(frame.number) + " took " +
                     text_of(frame.times[static_cast<std::size_t>(Span::kLatency)]) + " from capture to packet, " +
                     text_of(frame.times[index]) + " of it " + (part == Span::kWaiting ? "" : "in ") + describe(part) +
                     " (usually " + text_of(report.spans[index].p50) + ")" + explanation(report, frame, part);
  if (report.deadline > Duration::zero()) {
    text += "; the deadline of " + text_of(report.deadline) + " was missed by " +
            std::to_string(report.deadline_misses) + " of " + std::to_string(report.frames + report.lost) + " frames";
    if (report.lost > 0) text += ", " + std::to_string(report.lost) + " of them lost";
  }
  return text + ".";
}

}  // namespace touchline::latency
