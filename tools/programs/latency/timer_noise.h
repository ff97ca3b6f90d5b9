#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "core/time.h"
#include "firmware/latency_histogram.h"

namespace touchline::latency {

/// Delays of the timers of a thread beside the loop.
struct NoiseReport {
  std::uint64_t count = 0;
  Duration p50{}, p99{}, p99_9{}, max{};  // percentiles, at most 1.6 % too large
  std::string thread;                     // processor and priority of the thread

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("count", self.count);
    visit("p50_ns", self.p50);
    visit("p99_ns", self.p99);
    visit("p99.9_ns", self.p99_9);
    visit("max_ns", self.max);
    visit("thread", self.thread);
  }
};

/// A thread that sleeps until the next millisecond again and again and measures how late it wakes up, as cyclictest
/// does. It does nothing else, so only the machine can delay it: interrupts, other programs, a hypervisor.
class TimerNoise {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(1);

  /// `processor`: processor on which the thread runs; -1: any. `priority`: priority of SCHED_FIFO; 0: an ordinary
  /// thread. If the system refuses the priority, the thread is an ordinary one.
  TimerNoise(int processor, int priority);
  ~TimerNoise() { stop(); }
  TimerNoise(const TimerNoise&) = delete;
  TimerNoise& operator=(const TimerNoise&) = delete;

  /// Returns the longest delay since the last call, including a delay that still lasts. Any thread may call it.
  Duration take_longest();
  /// Ends the thread; further calls do nothing.
  void stop();
  /// Returns the report; call it after stop().
  [[nodiscard]] NoiseReport report() const;

 private:
  void run(Instant due, const std::stop_token& stop);

  LatencyHistogram histogram_;
  std::string description_;
  std::atomic<Duration::rep> longest_ns_ = 0, due_ns_ = 0;
  std::jthread thread_;
};

}  // namespace touchline::latency
