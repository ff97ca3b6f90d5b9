#include "tools/programs/latency/measurement.h"

#include <algorithm>
#include <numeric>

#include "tools/programs/latency/allocation_counter.h"

namespace touchline::latency {

Measurement::Measurement(std::size_t frames, std::size_t warm_up)
    : spans_(kSpanCount, LatencySamples(frames)), frames_(frames), warm_up_(warm_up) {
  begin();
}

void Measurement::begin() {
  usage_begin_ = ThreadUsage::of_this_thread();
  allocations_begin_ = allocations_of_this_thread();
}

void Measurement::end() {
  if (ended_) return;
  ended_ = true;
  usage_end_ = ThreadUsage::of_this_thread();
  allocations_end_ = allocations_of_this_thread();
}

void Measurement::on_step(void* context, const StepTrace& trace, const StepTiming& timing) {
  Measurement& self = *static_cast<Measurement*>(context);
  const std::uint32_t sequence = trace.frame.sequence;
  // The sequence restarts when the camera is reopened.
  const bool gap = self.last_sequence_ && sequence > *self.last_sequence_ + 1;
  if (gap && self.seen() >= self.warm_up_) self.lost_ += sequence - *self.last_sequence_ - 1;
  self.last_sequence_ = sequence;
  self.add(trace.stage_time, timing, trace.overload);
}

void Measurement::add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload) {
  const std::size_t seen = seen_.fetch_add(1, std::memory_order_relaxed) + 1;
  if (seen <= warm_up_) {
    if (seen == warm_up_) begin();
    return;
  }
  if (seen > warm_up_ + frames_) return;
  const auto add_to = [this](Span span, Duration time) { spans_[static_cast<std::size_t>(span)].add(time); };
  static_assert(static_cast<std::size_t>(Span::kSend) == static_cast<std::size_t>(Span::kRegion) + kStageCount);
  add_to(Span::kCamera, timing.latency - timing.processing);
  for (std::size_t i = 0; i < kStageCount; ++i) spans_[static_cast<std::size_t>(Span::kRegion) + i].add(stages[i]);
  add_to(Span::kSend, timing.processing - std::accumulate(stages.begin(), stages.end(), Duration::zero()));
  add_to(Span::kProcessing, timing.processing);
  add_to(Span::kLatency, timing.latency);
  overloads_ += overload ? 1u : 0u;
  if (seen == warm_up_ + frames_) end();
}

std::vector<WorstFrame> Measurement::worst(std::size_t count) const {
  const LatencySamples& latency = samples(Span::kLatency);
  std::vector<std::size_t> order(latency.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::partial_sort(order.begin(), end, order.end(), [&latency](std::size_t a, std::size_t b) {
    return latency[a] != latency[b] ? latency[a] > latency[b] : a < b;
  });
  std::vector<WorstFrame> frames;
  for (auto i = order.begin(); i != end; ++i) {
    WorstFrame& frame = frames.emplace_back();
    frame.number = *i + 1;
    for (std::size_t span = 0; span < kSpanCount; ++span) frame.times[span] = spans_[span][*i];
  }
  return frames;
}

LatencyReport Measurement::report(const std::string& source, const ReportSettings& expected) const {
  LatencyReport report;
  report.source = source;
  report.warm_up = warm_up_;
  report.rate_hz = expected.rate_hz;
  report.frames = samples(Span::kLatency).count();
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    report.spans[i] = spans_[i].summarize();
    for (std::size_t k = 0; k < spans_[i].count(); ++k) report.histograms[i].add(spans_[i][k]);
  }
  report.worst = worst(expected.worst);
  const Duration period = expected.rate_hz > 0.0 ? from_seconds(1.0 / expected.rate_hz) : Duration::zero();
  report.deadline = expected.deadline > Duration::zero() ? expected.deadline : period;
  const auto longer = [this](Span span, Duration limit) {
    return limit > Duration::zero() ? samples(span).longer_than(limit) : 0;
  };
  report.deadline_misses = longer(Span::kLatency, report.deadline);
  report.period_overruns = longer(Span::kProcessing, period);
  report.lost = lost_;
  report.overloads = overloads_;
  if (allocations_are_counted()) report.allocations = allocations_end_ - allocations_begin_;
  report.usage = usage_end_.since(usage_begin_);
  return report;
}

std::string Measurement::to_csv() const {
  std::string text;
  const auto add_line = [&text](const auto& value_of) {
    for (std::size_t i = 0; i < kSpanCount; ++i) text += (i > 0 ? "," : "") + value_of(static_cast<Span>(i));
    text += '\n';
  };
  add_line([](Span span) { return std::string(describe(span)); });
  for (std::size_t k = 0; k < samples(Span::kLatency).count(); ++k) {
    add_line([this, k](Span span) { return std::to_string(samples(span)[k].count()); });
  }
  return text;
}

}  // namespace touchline::latency
