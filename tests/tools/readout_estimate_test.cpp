// The rolling shutter's readout time from moments of objects whose motion is known.
#include "tools/programs/devices/judge/readout_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace touchline::devices {
namespace {

constexpr std::size_t kRows = 480;
constexpr double kPeriod_s = 1.0 / 60.0;

/// What a camera sees of a square that swings: `readout` in frame periods; `tilt`: lean per row of the place, as of an
/// arm that turns at the elbow.
struct Swing {
  double readout = 0.0, tilt = 0.0, noise = 0.001;
  double amplitude_x = 150.0, amplitude_y = 60.0;

  [[nodiscard]] std::vector<MovingObject> at(int frame, std::mt19937_64& random) const {
    const double t = readout / (kRows - 1);  // between rows
    double y = 240.0;
    const auto phase = [&](double shift) { return 0.13 * (frame + t * y) + shift; };
    // The time at which it is seen depends on its row.
    for (int i = 0; i < 20; ++i) y = 240.0 + amplitude_y * std::sin(1.3 * phase(0.4));
    MovingObject object;
    object.x = 320.0 + amplitude_x * std::sin(phase(0.0));
    object.y = y;
    const double vx = amplitude_x * 0.13 * std::cos(phase(0.0)), vy = amplitude_y * 0.169 * std::cos(1.3 * phase(0.4));
    std::normal_distribution<double> error(0.0, noise);
    object.lean = t * vx + tilt * (object.x - 320.0) + error(random);
    object.log_height = std::log(20.0) - std::log(1.0 - t * vy) + error(random);
    object.area = 4800.0;
    return {object};
  }
};

ReadoutEstimate measure(const Swing& swing, int frames = 600) {
  std::mt19937_64 random(7);
  ReadoutMeasurement measurement(kRows, kPeriod_s);
  for (int frame = 0; frame < frames; ++frame)
    measurement.add(static_cast<std::uint32_t>(frame), swing.at(frame, random));
  return measurement.estimate();
}

TEST(ReadoutEstimate, FindsTheReadoutOfSwingingObjects) {
  for (const double readout : {-0.9, 0.0, 0.3, 0.9}) {
    const ReadoutEstimate estimate = measure({.readout = readout});
    ASSERT_TRUE(estimate.known);
    EXPECT_NEAR(estimate.readout, readout, 0.01) << "in frame periods";
    EXPECT_LT(estimate.sigma, 0.02);
    EXPECT_LT(std::abs(estimate.readout - readout), 4.0 * estimate.sigma);
  }
}

TEST(ReadoutEstimate, AnArmThatTurnsIsNoRollingShutter) {
  const ReadoutEstimate estimate = measure({.readout = 0.3, .tilt = 0.002});
  ASSERT_TRUE(estimate.known);
  EXPECT_NEAR(estimate.readout, 0.3, 0.02);
}

TEST(ReadoutEstimate, TheUncertaintyIsThatOfRepeatedMeasurements) {
  double squares = 0.0, stated = 0.0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(static_cast<std::uint64_t>(run));
    const Swing swing{.readout = 0.3, .noise = 0.01};
    ReadoutMeasurement measurement(kRows, kPeriod_s);
    for (int frame = 0; frame < 400; ++frame) {
      measurement.add(static_cast<std::uint32_t>(frame), swing.at(frame, random));
    }
    const ReadoutEstimate estimate = measurement.estimate();
    squares += (estimate.readout - 0.3) * (estimate.readout - 0.3) / kRuns;
    stated += estimate.sigma / kRuns;
  }
  EXPECT_GT(stated, 0.6 * std::sqrt(squares));
  EXPECT_LT(stated, 1.6 * std::sqrt(squares));
}

TEST(ReadoutEstimate, NothingIsKnownWithoutMotionOrFromOnePass) {
  EXPECT_FALSE(ReadoutMeasurement(kRows, kPeriod_s).estimate().known);
  const ReadoutEstimate still = measure({.readout = 0.3, .amplitude_x = 0.0, .amplitude_y = 0.0});
  EXPECT_TRUE(!still.known || still.sigma > 1.0);
  EXPECT_FALSE(measure({.readout = 0.3}, 30).known) << "half a second";
}

// The program pauses for a tenth of a second each second, as for an estimate, or gets every second frame only.
TEST(ReadoutEstimate, PausesAndASlowComputerDoNotMatter) {
  for (const bool every_second : {false, true}) {
    std::mt19937_64 random(3);
    ReadoutMeasurement measurement(kRows, kPeriod_s);
    const Swing swing{.readout = 0.5};
    for (int frame = 0; frame < 900; ++frame) {
      if (every_second ? frame % 2 == 0 : frame % 60 < 6) continue;
      measurement.add(static_cast<std::uint32_t>(frame), swing.at(frame, random));
    }
    const ReadoutEstimate estimate = measurement.estimate();
    ASSERT_TRUE(estimate.known);
    EXPECT_NEAR(estimate.readout, 0.5, 0.02);
  }
}

TEST(ReadoutEstimate, LostFramesDoNotMatter) {
  std::mt19937_64 random(3);
  ReadoutMeasurement measurement(kRows, kPeriod_s);
  const Swing swing{.readout = 0.5};
  for (int frame = 0; frame < 900; ++frame) {
    if (frame % 50 == 0) continue;
    measurement.add(static_cast<std::uint32_t>(frame), swing.at(frame, random));
  }
  const ReadoutEstimate estimate = measurement.estimate();
  ASSERT_TRUE(estimate.known);
  EXPECT_NEAR(estimate.readout, 0.5, 0.02);
}

}  // namespace
}  // namespace touchline::devices
