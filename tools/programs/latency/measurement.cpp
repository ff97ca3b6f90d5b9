#include "tools/programs/latency/measurement.h"

#include <algorithm>
#include <numeric>

#include "hal/linux/monotonic_clock.h"
#include "tools/programs/latency/allocation_counter.h"
#include "tools/programs/latency/stall_detection.h"

namespace touchline::latency {

Measurement::Measurement(std::size_t frames, std::size_t warm_up)
    : spans_(kSpanCount, LatencySamples(frames)), waits_(frames), frames_(frames), warm_up_(warm_up) {
  lost_frames_.reserve(frames);
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

void Measurement::on_received(void* context) { static_cast<Measurement*>(context)->meter_.begin_frame(); }

void Measurement::on_sent(void* context) { static_cast<Measurement*>(context)->meter_.end_frame(); }

void Measurement::on_step(void* context, const StepTrace& trace, const StepTiming& timing) {
  Measurement& self = *static_cast<Measurement*>(context);
  const std::uint32_t sequence = trace.frame.sequence;
  // Prepares the recorder with the first frame; its allocations do not count if there is a warm-up.
  if (self.recorder_ != nullptr && self.seen() == 0) self.recorder_->prepare(trace.frame);
  self.add(trace.stage_time, timing, trace.overload, &self.meter_.frame());
  const Duration timer_late = self.noise_ != nullptr ? self.noise_->take_longest() : Duration::zero();
  if (self.led_ != nullptr) self.led_->add(trace.frame, timing.sent);
  if (self.is_recording()) {
    const std::size_t number = self.seen() - self.warm_up_;
    self.waits_[number - 1].timer_late = timer_late;
    if (self.recorder_ != nullptr) self.recorder_->add(trace, number, timing.latency);
    if (self.trace_ != nullptr) self.trace_->check(number, timing.latency);
  }
  // The sequence restarts when the camera is reopened.
  const bool gap = self.last_sequence_ && sequence > *self.last_sequence_ + 1;
  if (gap) self.add_lost(sequence - *self.last_sequence_ - 1, trace.frame.capture_time - self.last_capture_);
  self.last_sequence_ = sequence;
  self.last_capture_ = trace.frame.capture_time;
}

void Measurement::add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload,
                      const FrameExecution* execution) {
  const std::size_t seen = seen_.fetch_add(1, std::memory_order_relaxed) + 1;
  if (seen <= warm_up_) {
    if (seen == warm_up_) begin();
    return;
  }
  if (seen > warm_up_ + frames_) return;
  const auto add_to = [this](Span span, Duration time) { spans_[static_cast<std::size_t>(span)].add(time); };
  static_assert(static_cast<std::size_t>(Span::kSend) == kFirstExecuted + kStageCount);
  FrameWaits& waits = waits_[seen - warm_up_ - 1];
  Duration waiting{};
  const auto add_executed = [&](std::size_t part, Duration elapsed, Duration executed) {
    // The difference can be slightly negative, because the two clocks are read one after the other.
    if (execution != nullptr) waits.waited[part] = elapsed - std::clamp(executed, Duration::zero(), elapsed);
    waiting += waits.waited[part];
    spans_[kFirstExecuted + part].add(elapsed - waits.waited[part]);
  };
  add_to(Span::kCamera, timing.latency - timing.processing);
  for (std::size_t i = 0; i < kStageCount; ++i) {
    add_executed(i, stages[i], execution != nullptr ? execution->stages[i] : Duration::zero());
  }
  const Duration others = timing.processing - std::accumulate(stages.begin(), stages.end(), Duration::zero());
  add_executed(kStageCount, others, execution != nullptr ? execution->others : Duration::zero());
  add_to(Span::kWaiting, waiting);
  add_to(Span::kProcessing, timing.processing);
  add_to(Span::kLatency, timing.latency);
  if (execution != nullptr) {
    waits.ready_before = execution->ready_before;
    waits.ready_during = execution->ready_during;
    waits.usage = execution->usage;
  }
  overloads_ += overload ? 1u : 0u;
  if (seen == warm_up_ + frames_) end();
}

void Measurement::add_lost(std::uint64_t count, Duration gap) {
  const std::size_t recorded = samples(Span::kLatency).count();
  if (!is_recording()) return;
  lost_ += count;
  const Duration latency = samples(Span::kLatency)[recorded - 1];
  const Duration period = gap / static_cast<Duration::rep>(count + 1);
  for (std::uint64_t left = count; left > 0 && lost_frames_.size() < lost_frames_.capacity(); --left) {
    lost_frames_.push_back({recorded - 1, latency + static_cast<Duration::rep>(left) * period});
  }
}

SpanTimes Measurement::times_of(std::size_t frame) const {
  SpanTimes times{};
  for (std::size_t span = 0; span < kSpanCount; ++span) times[span] = spans_[span][frame];
  return times;
}

LatencySamples Measurement::with_lost_frames() const {
  const LatencySamples& latency = samples(Span::kLatency);
  LatencySamples all(latency.count() + lost_frames_.size());
  auto lost = lost_frames_.begin();
  for (std::size_t i = 0; i < latency.count(); ++i) {
    for (; lost != lost_frames_.end() && lost->before <= i; ++lost) all.add(lost->latency);
    all.add(latency[i]);
  }
  return all;
}

void Measurement::add_stalls(LatencyReport& report, std::size_t listed) const {
  if (report.rate_hz <= 0.0) return;
  std::vector<FrameLateness> frames(samples(Span::kLatency).count());
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].latency = time(Span::kLatency, i);
  for (const LostFrame& lost : lost_frames_) ++frames[lost.before].lost_before;
  const Duration usual = report.spans[static_cast<std::size_t>(Span::kLatency)].p50;
  for (const StallExtent& extent : find_stalls(frames, usual, from_seconds(1.0 / report.rate_hz))) {
    ++report.stall_count;
    report.stall_delayed += extent.delayed;
    report.stall_lost += extent.lost;
    report.stalls.push_back({extent.first + 1, time(Span::kLatency, extent.first) - usual,
                             most_delayed_span(report, times_of(extent.first)), extent.delayed, extent.lost});
  }
  std::stable_sort(report.stalls.begin(), report.stalls.end(),
                   [](const Stall& a, const Stall& b) { return a.excess > b.excess; });
  report.stalls.resize(std::min(listed, report.stalls.size()));
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
    frame.times = times_of(*i);
    frame.waits = waits_[*i];
  }
  return frames;
}

LatencyReport Measurement::report(const std::string& source, const ReportSettings& expected) const {
  LatencyReport report;
  report.source = source;
  report.warm_up = warm_up_;
  report.rate_hz = expected.rate_hz;
  report.frames = samples(Span::kLatency).count();
  const LatencySamples latency = with_lost_frames();
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    const LatencySamples& all = static_cast<Span>(i) == Span::kLatency ? latency : spans_[i];
    report.spans[i] = all.summarize();
    for (std::size_t k = 0; k < all.count(); ++k) report.histograms[i].add(all[k]);
  }
  report.worst = worst(expected.worst);
  const Duration period = expected.rate_hz > 0.0 ? from_seconds(1.0 / expected.rate_hz) : Duration::zero();
  report.deadline = expected.deadline > Duration::zero() ? expected.deadline : period;
  const auto longer = [this](Span span, Duration limit) {
    return limit > Duration::zero() ? samples(span).longer_than(limit) : 0;
  };
  // A lost frame misses every deadline.
  if (report.deadline > Duration::zero()) report.deadline_misses = longer(Span::kLatency, report.deadline) + lost_;
  report.rare_frames = {
      estimate_rare_frames(describe(Span::kLatency), latency, report.deadline),
      estimate_rare_frames(describe(Span::kProcessing), samples(Span::kProcessing), Duration::zero())};
  report.period_overruns = longer(Span::kProcessing, period);
  report.lost = lost_;
  report.overloads = overloads_;
  add_stalls(report, expected.worst);
  if (allocations_are_counted()) report.allocations = allocations_end_ - allocations_begin_;
  report.usage = usage_end_.since(usage_begin_);
  return report;
}

std::string Measurement::to_csv() const {
  std::string text;
  const auto add_line = [&text](const auto& value_of, const std::string& lost) {
    for (std::size_t i = 0; i < kSpanCount; ++i) text += value_of(static_cast<Span>(i)) + ",";
    text += lost + "\n";
  };
  add_line([](Span span) { return std::string(describe(span)); }, "lost before");
  auto lost = lost_frames_.begin();
  for (std::size_t k = 0; k < samples(Span::kLatency).count(); ++k) {
    const auto first = lost;
    while (lost != lost_frames_.end() && lost->before <= k) ++lost;
    add_line([this, k](Span span) { return std::to_string(time(span, k).count()); }, std::to_string(lost - first));
  }
  return text;
}

}  // namespace touchline::latency
