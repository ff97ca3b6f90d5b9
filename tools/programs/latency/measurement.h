#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "firmware/loop.h"
#include "tools/programs/latency/execution_meter.h"
#include "tools/programs/latency/kernel_trace.h"
#include "tools/programs/latency/latency_report.h"
#include "tools/programs/latency/latency_samples.h"
#include "tools/programs/latency/led_watch.h"
#include "tools/programs/latency/worst_frame_recorder.h"

namespace touchline::latency {

/// Settings of the report.
struct ReportSettings {
  double rate_hz = 0.0;   // frame rate; 0: unknown
  Duration deadline{};    // limit from capture to packet; zero: a period of `rate_hz`
  std::size_t worst = 5;  // number of frames to list
};

/// Records the times of every step after the warm-up. Only the constructor and report() allocate.
///
/// A lost frame counts as if the next packet were its packet, because robots waited until then for the information in
/// it. Its capture time is interpolated between the frames before and after it. Without this rule, a stall that loses
/// frames would leave only the best times (coordinated omission).
class Measurement {
 public:
  /// `frames`: largest number of frames to record.
  Measurement(std::size_t frames, std::size_t warm_up);
  /// Returns the observer to pass to Loop. This object must outlive the loop.
  [[nodiscard]] LoopObserver observer() {
    return {&Measurement::on_step, this, &Measurement::on_received, &Measurement::on_sent};
  }
  /// Sets a recorder that gets every frame after the warm-up; it must outlive the loop.
  void set_recorder(WorstFrameRecorder& recorder) { recorder_ = &recorder; }
  /// Sets a TimerNoise whose delays are recorded for each frame; it must outlive the loop.
  void set_noise(TimerNoise& noise) { noise_ = &noise; }
  /// Sets a trace that gets every frame after the warm-up; it must outlive the loop.
  void set_trace(KernelTrace& trace) { trace_ = &trace; }
  /// Sets a watch that gets every frame; it must outlive the loop.
  void set_led(LedWatch& led) { led_ = &led; }
  /// Returns the meter that measures the execution of the loop's thread.
  [[nodiscard]] ExecutionMeter& meter() { return meter_; }
  /// Call these on the loop's thread immediately before and after the loop runs; page faults, context switches and
  /// allocations count only between them. Counting stops earlier if the last frame is recorded. If the loop ends early,
  /// its final stop packets count too.
  void begin();
  void end();
  /// Adds a step. `stages`: from the beginning to the end of each stage. `execution`: null if it was not measured; then
  /// no waiting is recorded.
  void add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload,
           const FrameExecution* execution = nullptr);
  /// Adds frames that were lost before the last added one, after the warm-up. `gap`: time between the captures of the
  /// frames before and after them.
  void add_lost(std::uint64_t count, Duration gap);

  /// Returns the number of steps so far, including the warm-up. May be called from any thread.
  [[nodiscard]] std::size_t seen() const { return seen_.load(std::memory_order_relaxed); }
  /// Makes the report, including the activities that took the processor from the loop. Call it on the measured thread.
  [[nodiscard]] LatencyReport report(const std::string& source, const ReportSettings& expected) const;
  /// Returns a head line with the names of the spans, then a line per frame in nanoseconds.
  [[nodiscard]] std::string to_csv() const;

 private:
  static void on_received(void* context);
  static void on_sent(void* context);
  static void on_step(void* context, const StepTrace& trace, const StepTiming& timing);
  [[nodiscard]] const LatencySamples& samples(Span span) const { return spans_[static_cast<std::size_t>(span)]; }
  // Returns whether the last frame was recorded.
  [[nodiscard]] bool is_recording() const { return seen() > warm_up_ && seen() <= warm_up_ + frames_; }
  [[nodiscard]] Duration time(Span span, std::size_t frame) const { return samples(span)[frame]; }
  [[nodiscard]] SpanTimes times_of(std::size_t frame) const;
  [[nodiscard]] LatencySamples with_lost_frames() const;
  [[nodiscard]] std::vector<WorstFrame> worst(std::size_t count) const;
  void add_stalls(LatencyReport& report, std::size_t listed) const;

  struct LostFrame {
    std::size_t before = 0;  // number of recorded frames before the lost one
    Duration latency{};
  };
  std::vector<LatencySamples> spans_;
  std::vector<FrameWaits> waits_;
  std::vector<LostFrame> lost_frames_;  // the first lost frames, up to the capacity
  ExecutionMeter meter_;
  WorstFrameRecorder* recorder_ = nullptr;
  TimerNoise* noise_ = nullptr;
  KernelTrace* trace_ = nullptr;
  LedWatch* led_ = nullptr;
  std::size_t frames_, warm_up_;
  std::atomic<std::size_t> seen_ = 0;
  bool ended_ = false;
  std::uint64_t overloads_ = 0, lost_ = 0;
  std::optional<std::uint32_t> last_sequence_;
  Instant last_capture_{};
  ThreadUsage usage_begin_, usage_end_;
  std::uint64_t allocations_begin_ = 0, allocations_end_ = 0;
};

}  // namespace touchline::latency
