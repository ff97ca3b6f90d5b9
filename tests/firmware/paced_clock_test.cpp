#include "firmware/paced_clock.h"

#include <gtest/gtest.h>

namespace touchline {
namespace {

using namespace std::chrono_literals;

class JumpingClock final : public hal::Clock {
 public:
  [[nodiscard]] Instant now() const override { return now_; }
  void sleep_until(Instant instant) override { now_ = std::max(now_, instant); }

 private:
  Instant now_ = Instant(1000s);
};

TEST(PacedClock, SimulatedTimePassesAsFastAsRealTime) {
  JumpingClock simulated;
  const hal::mock::ArenaPace pace;
  PacedClock clock(simulated, pace);
  const Instant begin = hal::MonotonicClock::read(), simulated_begin = clock.now();
  for (int i = 1; i <= 10; ++i) {
    clock.sleep_until(simulated_begin + i * 10ms);
    EXPECT_EQ(clock.now(), simulated_begin + i * 10ms);
  }
  clock.sleep_until(simulated_begin);
  const Duration elapsed = hal::MonotonicClock::read() - begin;
  EXPECT_GE(elapsed, 99ms);
  EXPECT_LT(elapsed, 5s);
}

TEST(PacedClock, TheSpeedOfTheArenaCountsFromItsChangeOn) {
  JumpingClock simulated;
  hal::mock::ArenaPace pace;
  PacedClock clock(simulated, pace);
  pace.set_speed(100.0);
  const Instant begin = hal::MonotonicClock::read(), simulated_begin = clock.now();
  clock.sleep_until(simulated_begin + 2s);
  pace.set_speed(0.5);
  clock.sleep_until(simulated_begin + 2s + 10ms);
  const Duration elapsed = hal::MonotonicClock::read() - begin;
  EXPECT_GE(elapsed, 39ms);
  EXPECT_LT(elapsed, 1900ms) << "at real time, two seconds would have passed";
}

TEST(ArenaPace, AFrameThatWasDueAtThePauseIsNoneOfTheNextStep) {
  hal::mock::ArenaPace pace;
  pace.count_frame();
  EXPECT_FALSE(pace.stands());
  pace.pause();
  pace.count_frame();
  EXPECT_TRUE(pace.stands());
  pace.step(2);
  pace.step(1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(pace.stands()) << "after " << i << " of three frames";
    pace.count_frame();
  }
  EXPECT_TRUE(pace.stands());
  pace.resume();
  pace.count_frame();
  EXPECT_FALSE(pace.stands());
}

}  // namespace
}  // namespace touchline
