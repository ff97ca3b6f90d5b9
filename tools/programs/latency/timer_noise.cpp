#include "tools/programs/latency/timer_noise.h"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>

#include "hal/linux/monotonic_clock.h"

namespace touchline::latency {

TimerNoise::TimerNoise(int processor, int priority) {
  const Instant first = hal::MonotonicClock::read() + kPeriod;
  thread_ = std::jthread([this, first](const std::stop_token& stop) { run(first, stop); });
  const pthread_t thread = thread_.native_handle();
  cpu_set_t set;
  CPU_ZERO(&set);
  if (processor >= 0) CPU_SET(static_cast<std::size_t>(processor), &set);
  const bool pinned = processor >= 0 && pthread_setaffinity_np(thread, sizeof set, &set) == 0;
  sched_param parameters{};
  parameters.sched_priority = std::min(priority, sched_get_priority_max(SCHED_FIFO));
  const bool raised = priority > 0 && pthread_setschedparam(thread, SCHED_FIFO, &parameters) == 0;
  description_ =
      (pinned ? "on processor " + std::to_string(processor) : std::string("on any processor")) +
      (raised ? ", SCHED_FIFO priority " + std::to_string(parameters.sched_priority) : ", ordinary priority");
}

void TimerNoise::run(Instant due, const std::stop_token& stop) {
  prctl(PR_SET_TIMERSLACK, 1);
  prctl(PR_SET_NAME, "timer-noise");  // name in the list of programs that took the processor from the loop
  do {
    due_ns_.store(due.time_since_epoch().count(), std::memory_order_relaxed);
    hal::MonotonicClock::wait_for(due);
    const Instant now = hal::MonotonicClock::read();
    const Duration late = now - due;
    histogram_.add(late);
    Duration::rep longest = longest_ns_.load(std::memory_order_relaxed);
    while (late.count() > longest && !longest_ns_.compare_exchange_weak(longest, late.count())) {
    }
    // Each period that has passed in the meantime was late by the part of the delay after it.
    for (due += kPeriod; due < now; due += kPeriod) histogram_.add(now - due);
  } while (!stop.stop_requested());
}

Duration TimerNoise::take_longest() {
  const Instant due{Duration(due_ns_.load(std::memory_order_relaxed))};
  const Duration recorded(longest_ns_.exchange(0, std::memory_order_relaxed));
  if (due == Instant{}) return recorded;
  return std::max(recorded, hal::MonotonicClock::read() - due);
}

void TimerNoise::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

NoiseReport TimerNoise::report() const {
  return {histogram_.count(),           histogram_.percentile(0.5), histogram_.percentile(0.99),
          histogram_.percentile(0.999), histogram_.max(),           description_};
}

}  // namespace touchline::latency
