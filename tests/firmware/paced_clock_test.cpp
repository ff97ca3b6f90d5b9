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
  PacedClock clock(simulated);
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

}  // namespace
}  // namespace touchline
