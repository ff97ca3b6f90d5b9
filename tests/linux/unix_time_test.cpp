#include "hal/linux/unix_time.h"

#include <chrono>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

TEST(UnixTime, OffsetAgreesWithBothClocks) {
  const UnixTimeOffset offset = measure_unix_time_offset();
  EXPECT_GE(offset.uncertainty, 0ns);
  EXPECT_LT(offset.uncertainty, 100us);
  const Duration now = offset.to_unix(MonotonicClock::read());
  const Duration expected = std::chrono::system_clock::now().time_since_epoch();
  EXPECT_LT(std::chrono::abs(expected - now), 100ms);
}

TEST(UnixTime, TextNamesUncertaintyAndSynchronization) {
  UnixTimeOffset offset{std::chrono::seconds(1700000000) + 123456us, 40ns, true, 1200us};
  EXPECT_EQ(describe(offset),
            "Unix time = monotonic time + 1700000000.123456 s, +- 0.04 us; the clock is synchronized within 1.2 ms");
  offset.synchronized = false;
  EXPECT_EQ(describe(offset),
            "Unix time = monotonic time + 1700000000.123456 s, +- 0.04 us; the clock is not synchronized "
            "(docs/network.md)");
  EXPECT_EQ(short_text(offset), "Unix time +1700000000.123456 s +-0.04 us");
}

TEST(UnixTime, ClockThatWasSetDiffers) {
  const UnixTimeOffset before{std::chrono::seconds(1700000000), 40ns};
  const auto after = [&](Duration step) { return UnixTimeOffset{before.offset + step, 60ns}; };
  for (const Duration step : {0ns, 100ns, -100ns}) EXPECT_FALSE(differ(before, after(step))) << step.count();
  for (const Duration step : {101ns, -101ns}) EXPECT_TRUE(differ(before, after(step))) << step.count();
}

}  // namespace
}  // namespace touchline::hal
