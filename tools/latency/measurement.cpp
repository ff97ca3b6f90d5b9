#include "tools/latency/measurement.h"

#include <sys/resource.h>

#include "tools/latency/allocation_counter.h"

namespace touchline::latency {

const char* describe(Span span) noexcept {
  switch (span) {
    case Span::kRegion:
      return "color and region";
    case Span::kMarker:
      return "marker";
    case Span::kTrack:
      return "track";
    case Span::kControl:
      return "control";
    case Span::kRadio:
      return "packet";
    case Span::kProcessing:
      return "frame to sent";
    case Span::kLatency:
      return "capture to sent";
  }
  return "";
}

PageFaults PageFaults::of_this_thread() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt)};
}

Measurement::Measurement(std::size_t frames, std::size_t warm_up)
    : spans_(kSpanCount, LatencySamples(frames)), frames_(frames), warm_up_(warm_up) {
  // Without warm-up everything from here on counts.
  faults_begin_ = PageFaults::of_this_thread();
  allocations_begin_ = allocations_of_this_thread();
}

void Measurement::on_step(void* context, const StepTrace& trace, const StepTiming& timing) {
  static_cast<Measurement*>(context)->add(trace.stage_time, timing, trace.overload);
}

void Measurement::add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload) {
  const std::size_t seen = seen_.fetch_add(1, std::memory_order_relaxed) + 1;
  if (seen <= warm_up_) {
    if (seen == warm_up_) {
      faults_begin_ = PageFaults::of_this_thread();
      allocations_begin_ = allocations_of_this_thread();
    }
    return;
  }
  if (seen > warm_up_ + frames_) return;
  for (std::size_t i = 0; i < kStageCount; ++i) spans_[i].add(stages[i]);
  spans_[static_cast<std::size_t>(Span::kProcessing)].add(timing.processing);
  spans_[static_cast<std::size_t>(Span::kLatency)].add(timing.latency);
  overloads_ += overload ? 1u : 0u;
  if (seen == warm_up_ + frames_) {
    faults_end_ = PageFaults::of_this_thread();
    allocations_end_ = allocations_of_this_thread();
  }
}

LatencyReport Measurement::report(const std::string& source, double rate_hz) const {
  LatencyReport report;
  report.source = source;
  report.warm_up = warm_up_;
  report.rate_hz = rate_hz;
  report.frames = samples(Span::kProcessing).count();
  for (std::size_t i = 0; i < kSpanCount; ++i) report.spans[i] = spans_[i].summarize();
  report.deadline_misses = samples(Span::kProcessing).longer_than(from_seconds(1.0 / rate_hz));
  report.overloads = overloads_;
  report.allocations_counted = allocations_are_counted();
  // A run that ended early has no end of its own.
  const bool whole = seen() >= warm_up_ + frames_;
  const PageFaults faults = whole ? faults_end_ : PageFaults::of_this_thread();
  const std::uint64_t allocations = whole ? allocations_end_ : allocations_of_this_thread();
  if (seen() >= warm_up_) {
    report.minor_faults = faults.minor - faults_begin_.minor;
    report.major_faults = faults.major - faults_begin_.major;
    report.allocations = allocations - allocations_begin_;
  }
  return report;
}

}  // namespace touchline::latency
