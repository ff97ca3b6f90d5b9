#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "core/time.h"
#include "firmware/latency_histogram.h"

namespace touchline::latency {

/// How late the timers of a thread beside the loop were.
struct NoiseReport {
  std::uint64_t count = 0;
  Duration p50{}, p99{}, p99_9{}, max{};  // percentiles at most 1.6 % too large
  std::string thread;                     // its processor and priority

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
/// does. It does nothing else, so what delays it is the machine: interrupts, other programs, a hypervisor.
class TimerNoise {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(1);

  /// `processor`: where the thread runs; -1: anywhere. `priority`: of SCHED_FIFO, 0: an ordinary thread. The thread has
  /// ordinary priority if the system refuses.
  TimerNoise(int processor, int priority);
  ~TimerNoise() { stop(); }
  TimerNoise(const TimerNoise&) = delete;
  TimerNoise& operator=(const TimerNoise&) = delete;

  /// The longest delay since the last call, including one that still lasts. Any thread may call it.
  Duration take_longest();
  /// Ends the thread. Idempotent.
  void stop();
  /// After stop().
  [[nodiscard]] NoiseReport report() const;

 private:
  void run(Instant due, const std::stop_token& stop);

  LatencyHistogram histogram_;
  std::string description_;
  std::atomic<Duration::rep> longest_ns_ = 0, due_ns_ = 0;
  std::jthread thread_;
};

}  // namespace touchline::latency
