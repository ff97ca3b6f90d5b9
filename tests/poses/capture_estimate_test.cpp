#include "hal/poses/capture_estimate.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

double milliseconds(Duration d) { return seconds(d) * 1e3; }

/// A vision system whose clock began elsewhere and runs too fast by `drift`, with a network of 0.2 ms and jitter.
struct Sender {
  double offset_s = 1.7e9, drift = 0.0, processing_s = 0.008;
  std::mt19937 random{1};
  std::exponential_distribution<double> jitter{1.0 / 0.002};

  struct Stamps {
    double captured_s, sent_s;
    Instant captured, arrival;
  };
  Stamps frame(double t_s) {
    const double sent_s = t_s + processing_s, arrival_s = sent_s + 0.0002 + jitter(random);
    return {offset_s + t_s * (1.0 + drift), offset_s + sent_s * (1.0 + drift), Instant(from_seconds(t_s)),
            Instant(from_seconds(arrival_s))};
  }
};

TEST(CaptureEstimate, FindsTheTimeOfCaptureBehindJitterAndClocks) {
  for (const double drift : {-5e-5, 0.0, 5e-5}) {
    Sender sender;
    sender.drift = drift;
    CaptureEstimate estimate;
    double worst_ms = 0.0, mean_ms = 0.0;
    int count = 0;
    for (double t = 100.0; t < 160.0; t += 1.0 / 60.0) {
      const Sender::Stamps stamps = sender.frame(t);
      const Instant found = estimate.capture_time(stamps.captured_s, stamps.sent_s, stamps.arrival);
      EXPECT_LE(found, stamps.arrival);
      if (t < 101.0) continue;
      const double error_ms = milliseconds(found - stamps.captured);
      worst_ms = std::max(worst_ms, std::abs(error_ms));
      mean_ms += error_ms;
      ++count;
    }
    EXPECT_LT(worst_ms, 0.8) << drift;
    EXPECT_GT(mean_ms / count, -0.6) << drift;
    EXPECT_LT(mean_ms / count, 0.4) << drift;
  }
}

TEST(CaptureEstimate, WithoutATimeOfSendingOnlyTheVariationIsRemoved) {
  Sender sender;
  CaptureEstimate estimate;
  Instant found{};
  Sender::Stamps stamps{};
  for (double t = 100.0; t < 105.0; t += 1.0 / 60.0) {
    stamps = sender.frame(t);
    found = estimate.capture_time(stamps.captured_s, std::nullopt, stamps.arrival);
  }
  EXPECT_NEAR(milliseconds(found - stamps.captured), 8.2, 0.1) << "processing and the shortest way";
}

TEST(CaptureEstimate, WithoutTimesTheArrivalCounts) {
  CaptureEstimate estimate;
  const Instant arrival{5s};
  EXPECT_EQ(estimate.capture_time(std::nullopt, std::nullopt, arrival), arrival);
  EXPECT_EQ(estimate.capture_time(1e300, 1e300, arrival), arrival) << "no clock";
}

TEST(CaptureEstimate, AClockThatIsSetIsFollowedAtOnce) {
  for (const double leap_s : {-3600.0, 3600.0, -2.0}) {
    Sender sender;
    CaptureEstimate estimate;
    for (double t = 100.0; t < 110.0; t += 1.0 / 60.0) {
      const Sender::Stamps stamps = sender.frame(t);
      static_cast<void>(estimate.capture_time(stamps.captured_s, stamps.sent_s, stamps.arrival));
    }
    sender.offset_s += leap_s;
    for (double t = 110.0; t < 111.0; t += 1.0 / 60.0) {
      const Sender::Stamps stamps = sender.frame(t);
      const Instant found = estimate.capture_time(stamps.captured_s, stamps.sent_s, stamps.arrival);
      EXPECT_LT(std::abs(milliseconds(found - stamps.captured)), 20.0) << leap_s;
    }
  }
}

}  // namespace
}  // namespace touchline::hal
