#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"
#include "firmware/loop.h"
#include "tools/latency/latency_samples.h"

namespace touchline::latency {

/// What is measured: the pipeline's stages, and the frame as a whole.
enum class Span : std::uint8_t { kRegion, kMarker, kTrack, kControl, kRadio, kProcessing, kLatency };
inline constexpr std::size_t kSpanCount = 7;
const char* describe(Span span) noexcept;

/// Page faults of the calling thread since it began.
struct PageFaults {
  std::uint64_t minor = 0, major = 0;
  static PageFaults of_this_thread();
};

struct LatencyReport {
  std::string source;
  std::uint64_t frames = 0, warm_up = 0;
  double rate_hz = 0.0;  // deadline: 1 / rate
  std::array<LatencySummary, kSpanCount> spans{};
  std::uint64_t deadline_misses = 0;  // frames whose processing took longer than a period
  std::uint64_t overloads = 0;
  std::uint64_t minor_faults = 0, major_faults = 0;  // of the loop's thread after warm-up
  std::uint64_t allocations = 0;                     // likewise
  bool allocations_counted = false;                  // false: built with a sanitizer, whose allocator is its own
};

/// Takes every step's times after the warm-up. Allocates in its constructor and nowhere else.
class Measurement {
 public:
  Measurement(std::size_t frames, std::size_t warm_up);
  /// For Loop; `this` is the context.
  [[nodiscard]] LoopObserver observer() { return {&Measurement::on_step, this}; }
  /// Stages in the order of Span up to kRadio.
  void add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload);

  /// Steps so far, warm-up included; from any thread.
  [[nodiscard]] std::size_t seen() const { return seen_.load(std::memory_order_relaxed); }
  [[nodiscard]] LatencyReport report(const std::string& source, double rate_hz) const;
  [[nodiscard]] const LatencySamples& samples(Span span) const { return spans_[static_cast<std::size_t>(span)]; }

 private:
  static void on_step(void* context, const StepTrace& trace, const StepTiming& timing);

  std::vector<LatencySamples> spans_;
  std::size_t frames_, warm_up_;
  std::atomic<std::size_t> seen_ = 0;
  std::uint64_t overloads_ = 0;
  PageFaults faults_begin_, faults_end_;
  std::uint64_t allocations_begin_ = 0, allocations_end_ = 0;
};

}  // namespace touchline::latency
