#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "firmware/loop.h"
#include "tools/programs/latency/latency_report.h"
#include "tools/programs/latency/latency_samples.h"

namespace touchline::latency {

/// What a measurement is held against.
struct Expected {
  double rate_hz = 0.0;   // 0: none known
  Duration deadline{};    // from capture to packet; zero: a period of `rate_hz`
  std::size_t worst = 5;  // frames to list
};

/// Takes every step's times after the warm-up. Allocates in its constructor and in report(), and nowhere else.
class Measurement {
 public:
  /// `frames`: as many as are kept at most.
  Measurement(std::size_t frames, std::size_t warm_up);
  /// For Loop; `this` is the context.
  [[nodiscard]] LoopObserver observer() { return {&Measurement::on_step, this}; }
  /// The loop begins, and has ended, unless all frames were seen before: what the thread does before and after does not
  /// count. (Where it ended early its last packets do: they stop the robots.)
  void begin();
  void end();
  void add(const std::array<Duration, kStageCount>& stages, const StepTiming& timing, bool overload);

  /// Steps so far, warm-up included; from any thread.
  [[nodiscard]] std::size_t seen() const { return seen_.load(std::memory_order_relaxed); }
  /// On the thread that was measured.
  [[nodiscard]] LatencyReport report(const std::string& source, const Expected& expected) const;

 private:
  static void on_step(void* context, const StepTrace& trace, const StepTiming& timing);
  [[nodiscard]] const LatencySamples& samples(Span span) const { return spans_[static_cast<std::size_t>(span)]; }
  [[nodiscard]] std::vector<WorstFrame> worst(std::size_t count) const;

  std::vector<LatencySamples> spans_;
  std::size_t frames_, warm_up_;
  std::atomic<std::size_t> seen_ = 0;
  bool ended_ = false;
  std::uint64_t overloads_ = 0, lost_ = 0;
  std::optional<std::uint32_t> last_sequence_;
  ThreadUsage usage_begin_, usage_end_;
  std::uint64_t allocations_begin_ = 0, allocations_end_ = 0;
};

}  // namespace touchline::latency
