#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>

#include "core/time.h"
#include "core/types.h"
#include "tools/programs/latency/thread_usage.h"

namespace touchline::latency {

/// Activity of the loop's thread between a frame's arrival and its packet.
struct FrameExecution {
  // Processor time, measured with CLOCK_THREAD_CPUTIME_ID: in the stages, and in everything else.
  std::array<Duration, kStageCount> stages{};
  Duration others{};
  ThreadUsage usage;
  // Time in which the thread was ready to run but had no processor: between the previous packet and this frame, and
  // during this frame. Zero if the kernel does not count it.
  Duration ready_before{}, ready_during{};
};

/// Measures FrameExecution from the calls of a LoopObserver and of the pipeline's stage clock. Never allocates after
/// construction. Each reading costs a system call (reading_cost()).
class ExecutionMeter {
 public:
  ExecutionMeter() = default;
  ~ExecutionMeter();
  ExecutionMeter(const ExecutionMeter&) = delete;
  ExecutionMeter& operator=(const ExecutionMeter&) = delete;

  /// Stage clock for Pipeline::configure: CLOCK_MONOTONIC. During a frame, it also stores the processor time in the
  /// meter whose begin_frame() this thread called last.
  static Instant read();
  void begin_frame();
  void end_frame();
  [[nodiscard]] const FrameExecution& frame() const { return frame_; }

  /// Sets a function that is called in the marker stage of each frame with the number of frames before it; tests and
  /// --plant use it to delay the stage.
  void set_intrusion(std::function<void(std::uint64_t frame)> intrusion) { intrusion_ = std::move(intrusion); }

  /// Returns the processor time of this thread.
  [[nodiscard]] static Duration processor_time();
  /// Returns the median time of a reading of the processor time; there are kReadings of them in a frame.
  [[nodiscard]] static Duration reading_cost();
  static constexpr std::size_t kReadings = kStageCount + 2;

 private:
  [[nodiscard]] Duration ready_time() const;

  FrameExecution frame_;
  ThreadUsage usage_begin_;
  Duration begin_{}, last_{}, ready_begin_{}, ready_end_{};
  std::size_t borders_ = 0;
  std::uint64_t frames_ = 0;
  std::function<void(std::uint64_t)> intrusion_;
  int schedule_file_ = -1;
};

}  // namespace touchline::latency
