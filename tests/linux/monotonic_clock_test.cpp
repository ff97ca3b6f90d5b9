#include "hal/linux/monotonic_clock.h"

#include <gtest/gtest.h>
#include <sys/time.h>

#include <chrono>
#include <csignal>

#include "tests/linux/fake_kernel.h"

namespace touchline::hal {
namespace {

using std::chrono::milliseconds;

TEST(MonotonicClock, IsTheClockOfTheDriversTimeStamps) {
  MonotonicClock clock;
  // libstdc++'s steady clock is also CLOCK_MONOTONIC on Linux.
  const auto before = std::chrono::steady_clock::now().time_since_epoch();
  const auto now = clock.now().time_since_epoch();
  const auto after = std::chrono::steady_clock::now().time_since_epoch();
  EXPECT_GE(now, before);
  EXPECT_LE(now, after);
}

TEST(MonotonicClock, SleepsUntilTheInstant) {
  MonotonicClock clock;
  const Instant goal = clock.now() + milliseconds(5);
  clock.sleep_until(goal);
  EXPECT_GE(clock.now(), goal);
  EXPECT_LT(clock.now(), goal + milliseconds(500)) << "a busy machine may be late, but not this late";
}

TEST(MonotonicClock, PastInstantsReturnImmediately) {
  fake::Kernel kernel;
  MonotonicClock clock;
  const Instant before = kernel.now();
  clock.sleep_until(before - milliseconds(1));
  clock.sleep_until(Instant{});
  clock.sleep_until(Instant(milliseconds(-1)));
  EXPECT_EQ(kernel.now(), before);
}

TEST(MonotonicClock, SignalsDoNotEndASleepEarly) {
  fake::Kernel kernel;
  MonotonicClock clock;
  kernel.interrupt_waits(3);
  const Instant goal = kernel.now() + milliseconds(50);
  clock.sleep_until(goal);
  EXPECT_EQ(kernel.now(), goal);
}

TEST(MonotonicClock, RealSignalsDoNotEndASleepEarly) {
  static volatile std::sig_atomic_t alarms = 0;
  alarms = 0;
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) { alarms = alarms + 1; };
  ASSERT_EQ(sigaction(SIGALRM, &action, &before), 0);
  const itimerval every_2_ms{{0, 2000}, {0, 2000}};
  ASSERT_EQ(setitimer(ITIMER_REAL, &every_2_ms, nullptr), 0);
  const Instant goal = MonotonicClock::read() + milliseconds(20);
  MonotonicClock::wait_for(goal);
  const Instant woken = MonotonicClock::read();
  const itimerval off{};
  ASSERT_EQ(setitimer(ITIMER_REAL, &off, nullptr), 0);
  ASSERT_EQ(sigaction(SIGALRM, &before, nullptr), 0);
  EXPECT_GE(woken, goal);
  EXPECT_GE(alarms, 1);
}

TEST(MonotonicClock, DeadlinesDoNotDrift) {
  fake::Kernel kernel;
  const Instant start = kernel.now();
  Instant next = start;
  for (int i = 0; i < 1000; ++i) {
    next += milliseconds(10);
    MonotonicClock::wait_for(next);
    static_cast<void>(MonotonicClock::read());  // work takes time
  }
  EXPECT_EQ(kernel.now(), start + milliseconds(10000) + std::chrono::microseconds(1));
}

}  // namespace
}  // namespace touchline::hal
