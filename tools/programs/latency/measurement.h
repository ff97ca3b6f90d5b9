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
  Duration deadline{};    // from capture to packet; zero: a period of `rate_hz`
  std::size_t worst = 5;  // frames to list
};

/// Records the times of every step after the warm-up. Only the constructor and report() allocate.
///
/// A lost frame counts as if the next packet were its packet: robots waited until then for what it showed. Its capture
/// time follows from the frames before and after it. Without that, a stall that loses frames would leave the best
/// times (coordinated omission).
class Measurement {
 public:
  /// `frames`: the largest number of frames that is recorded.
  Measurement(std::size_t frames, std::size_t warm_up);
  /// Observer to pass to Loop. This object must outlive the loop.
  [[nodiscard]] LoopObserver observer() {
    return {&Measurement::on_step, this, &Measurement::on_received, &Measurement::on_sent};
  }
  /// Gets every frame after the warm-up; must outlive the loop.
  void set_recorder(WorstFrameRecorder& recorder) { recorder_ = &recorder; }
  /// Its delays are recorded for each frame; must outlive the loop.
  void set_noise(TimerNoise& noise) { noise_ = &noise; }
  /// Gets every frame after the warm-up; must outlive the loop.
  void set_trace(KernelTrace& trace) { trace_ = &trace; }
  /// Gets every frame; must outlive the loop.
  void set_led(LedWatch& led) { led_ = &led; }
  /// Measures what the loop's thread executes.
  [[nodiscard]] ExecutionMeter& meter() { return meter_; }
  /// Call these on the loop's thread immediately before and after the loop runs; page faults, context switches and
  /// allocations count only between them. They stop counting earlier when the last frame is recorded. If the loop ends
  /// early, its final stop packets count too.
  void begin();
  void end();
  /// `stages`: from the beginning to the end of each. `execution`: null if it was not measured; then nothing waited.
  void add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload,
           const FrameExecution* execution = nullptr);
  /// Adds frames that were lost before the last added one, after the warm-up. `gap`: between the captures of the frames
  /// beside them.
  void add_lost(std::uint64_t count, Duration gap);

  /// Number of steps so far, including the warm-up. May be called from any thread.
  [[nodiscard]] std::size_t seen() const { return seen_.load(std::memory_order_relaxed); }
  /// Adds to a report of this measurement what took the processor from the loop.
  /// Makes the report. Call it on the measured thread.
  [[nodiscard]] LatencyReport report(const std::string& source, const ReportSettings& expected) const;
  /// A head with the names of the spans, then a line per frame in nanoseconds.
  [[nodiscard]] std::string to_csv() const;

 private:
  static void on_received(void* context);
  static void on_sent(void* context);
  static void on_step(void* context, const StepTrace& trace, const StepTiming& timing);
  [[nodiscard]] const LatencySamples& samples(Span span) const { return spans_[static_cast<std::size_t>(span)]; }
  // Whether the last frame was recorded.
  [[nodiscard]] bool is_recording() const { return seen() > warm_up_ && seen() <= warm_up_ + frames_; }
  [[nodiscard]] Duration time(Span span, std::size_t frame) const { return samples(span)[frame]; }
  [[nodiscard]] SpanTimes times_of(std::size_t frame) const;
  [[nodiscard]] LatencySamples with_lost_frames() const;
  [[nodiscard]] std::vector<WorstFrame> worst(std::size_t count) const;
  void add_stalls(LatencyReport& report, std::size_t listed) const;

  struct LostFrame {
    std::size_t before = 0;  // number of recorded frames before it
    Duration latency{};
  };
  std::vector<LatencySamples> spans_;
  std::vector<FrameWaits> waits_;
  std::vector<LostFrame> lost_frames_;  // the first ones
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
