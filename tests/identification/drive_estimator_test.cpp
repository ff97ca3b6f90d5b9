#include "core/identification/drive_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/identification/simulated_measurement.h"

// The goals: in 20 s, a delay of 20 to 120 ms is known to 3 ms, gains to 1 %, and a lag of 40 to 160 ms to 10 ms, also
// with errors that the model does not have.
namespace touchline {
namespace {

constexpr double kMeasured_s = 20.0;

struct DriveCase {
  const char* name;
  double delay_s, lag_s, dead_zone_mps, lag_error;
  SimulatedCamera camera{};
};

hal::mock::ArenaParameters arena_of(const DriveCase& drive) {
  hal::mock::ArenaParameters arena;  // with its usual slip, gain errors, jitter and lost packets
  arena.opponents = hal::mock::Opponents::kStand;
  arena.robot = {{hal::mock::Side::kOwn, 0, 0.0, 0.0, 0.0, {"red"}}};
  arena.radio.delay_s = drive.delay_s - arena.radio.jitter_s;
  arena.physics.wheel_lag_s = drive.lag_s;
  arena.physics.wheel_dead_zone_mps = drive.dead_zone_mps;
  arena.physics.wheel_lag_error = drive.lag_error;
  return arena;
}

// Errors of a measurement.
struct Errors {
  double delay_s, lag_s, gain_left, gain_right, dead_zone_mps, wheel_base_m;
};

Errors errors_of(const DriveEstimate& measured, const DriveCase& drive, const hal::mock::World::Motors& motors,
                 double wheel_base_m) {
  return {measured.delay_s.value - drive.delay_s,
          measured.lag_s.value - 0.5 * (motors.lag_s[0] + motors.lag_s[1]),
          measured.gain_left.value - motors.gain[0],
          measured.gain_right.value - motors.gain[1],
          measured.dead_zone_mps.value - drive.dead_zone_mps,
          measured.wheel_base_m.value - wheel_base_m};
}

class DriveEstimatorTest : public testing::TestWithParam<DriveCase> {};

TEST_P(DriveEstimatorTest, MeetsTheGoals) {
  const DriveCase& drive = GetParam();
  const hal::mock::ArenaParameters arena = arena_of(drive);
  double gain_square = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulatedMeasurement measurement(arena, drive.camera, seed);
    measurement.run(kMeasured_s);
    measurement.estimator.solve();
    const DriveEstimate& measured = measurement.estimator.estimate();
    const Errors errors = errors_of(measured, drive, measurement.world().motors(0), arena.physics.wheel_base_m);
    EXPECT_TRUE(measured.is_wiring_known);
    EXPECT_EQ(measured.wiring, WheelWiring());
    EXPECT_TRUE(measured.delay_s.is_known);
    EXPECT_TRUE(measured.lag_s.is_known);
    EXPECT_LT(std::abs(errors.delay_s), 0.003) << "seed " << seed;
    EXPECT_LT(std::abs(errors.lag_s), 0.010) << "seed " << seed;
    EXPECT_LT(std::abs(errors.dead_zone_mps), 0.003) << "seed " << seed;
    EXPECT_LT(std::abs(errors.wheel_base_m), 0.001) << "seed " << seed;
    // The dead zone, which is measured too, doubles the gain's error: its standard deviation is 0.5 %.
    EXPECT_LT(std::abs(errors.gain_left), 0.02) << "seed " << seed;
    EXPECT_LT(std::abs(errors.gain_right), 0.02) << "seed " << seed;
    gain_square += (errors.gain_left * errors.gain_left + errors.gain_right * errors.gain_right) / 6.0;
  }
  EXPECT_LT(std::sqrt(gain_square), 0.01);
}

INSTANTIATE_TEST_SUITE_P(
    Drives, DriveEstimatorTest,
    testing::Values(DriveCase{"Fast", 0.02, 0.04, 0.0, 0.0}, DriveCase{"Usual", 0.018, 0.08, 0.0, 0.0},
                    DriveCase{"Slow", 0.12, 0.16, 0.0, 0.0}, DriveCase{"LateAndFast", 0.12, 0.04, 0.0, 0.0},
                    DriveCase{"EarlyAndSlow", 0.02, 0.16, 0.0, 0.0}, DriveCase{"DeadZone", 0.06, 0.08, 0.04, 0.0},
                    DriveCase{"UnequalMotors", 0.06, 0.08, 0.02, 0.1},
                    DriveCase{"SlowCamera", 0.06, 0.08, 0.0, 0.0, {30.0, 0.006, 0.0002, 0.002}},
                    DriveCase{"OftenHidden", 0.06, 0.08, 0.0, 0.0, {60.0, 0.006, 0.0002, 0.002, 0.2}}),
    [](const testing::TestParamInfo<DriveCase>& drive) { return std::string(drive.param.name); });

// Squares of the errors in units of the stated standard deviations, over many seeds (NEES per parameter).
TEST(DriveEstimator, StatesItsErrors) {
  for (const DriveCase& drive :
       {DriveCase{"", 0.06, 0.08, 0.03, 0.0}, DriveCase{"", 0.06, 0.08, 0.0, 0.0, {60.0, 0.006, 0.001, 0.017}}}) {
    const hal::mock::ArenaParameters arena = arena_of(drive);
    constexpr int kSeeds = 24;
    std::array<double, 4> squares{};
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      SimulatedMeasurement measurement(arena, drive.camera, seed);
      measurement.run(kMeasured_s);
      measurement.estimator.solve();
      const DriveEstimate& measured = measurement.estimator.estimate();
      const Errors errors = errors_of(measured, drive, measurement.world().motors(0), arena.physics.wheel_base_m);
      const std::array<double, 4> in_sigmas{
          errors.delay_s / measured.delay_s.sigma, errors.lag_s / measured.lag_s.sigma,
          errors.gain_left / measured.gain_left.sigma, errors.gain_right / measured.gain_right.sigma};
      for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += in_sigmas[i] * in_sigmas[i] / kSeeds;
    }
    // The mean of 24 squares is between 0.5 and 1.65 with a probability of 95 %. Lost packets and jitter bend the
    // response, which makes the lag's error up to 0.3 ms, so its square may be larger.
    for (std::size_t i = 0; i < squares.size(); ++i) {
      EXPECT_GT(squares[i], 0.4) << i;
      EXPECT_LT(squares[i], i == 1 ? 3.5 : 2.0) << i;
    }
  }
}

TEST(DriveEstimator, IsNotSettledAtALimit) {
  // Beyond the limit of 1 s.
  const hal::mock::ArenaParameters arena = arena_of({"", 0.06, 1.6, 0.0, 0.0});
  SimulatedMeasurement measurement(arena, {}, 1);
  measurement.run(kMeasured_s);
  measurement.estimator.solve();
  // The steps are limited, too.
  for (int pass = 0; pass < 20; ++pass) {
    std::size_t intervals = 100'000;
    ASSERT_TRUE(measurement.estimator.work(intervals));
  }
  const DriveEstimate& measured = measurement.estimator.estimate();
  EXPECT_EQ(std::max(measured.lag_left_s.value, measured.lag_right_s.value), 1.0);
  EXPECT_FALSE(measured.is_settled);
  EXPECT_FALSE(measured.delay_s.is_known || measured.lag_s.is_known || measured.gain_left.is_known);
}

// The table of core/identification/README.md: TOUCHLINE_SEEDS=60 identification_test
// --gtest_filter='*TheErrorsOfTheTable'
TEST(DriveEstimator, TheErrorsOfTheTable) {
  const char* const wanted = std::getenv("TOUCHLINE_SEEDS");  // NOLINT(concurrency-mt-unsafe): one thread
  const int seeds = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 6;
  const SimulatedCamera coarse{60.0, 0.006, 0.001, 0.017};
  for (const DriveCase& drive : {DriveCase{"23 ms, 40 ms", 0.023, 0.04, 0.0, 0.0},
                                 DriveCase{"63 ms, 80 ms, dead zone, unequal lags", 0.063, 0.08, 0.03, 0.1},
                                 DriveCase{"123 ms, 160 ms, the same", 0.123, 0.16, 0.03, 0.1},
                                 DriveCase{"63 ms, 80 ms, coarse sightings", 0.063, 0.08, 0.0, 0.0, coarse}}) {
    const hal::mock::ArenaParameters arena = arena_of(drive);
    Errors squares{};
    for (int seed = 1; seed <= seeds; ++seed) {
      SimulatedMeasurement measurement(arena, drive.camera, static_cast<std::uint64_t>(seed));
      measurement.run(kMeasured_s);
      measurement.estimator.solve();
      const Errors errors =
          errors_of(measurement.estimator.estimate(), drive, measurement.world().motors(0), arena.physics.wheel_base_m);
      squares.delay_s += errors.delay_s * errors.delay_s / seeds;
      squares.lag_s += errors.lag_s * errors.lag_s / seeds;
      squares.gain_left +=
          (errors.gain_left * errors.gain_left + errors.gain_right * errors.gain_right) / (2.0 * seeds);
      squares.dead_zone_mps += errors.dead_zone_mps * errors.dead_zone_mps / seeds;
      squares.wheel_base_m += errors.wheel_base_m * errors.wheel_base_m / seeds;
    }
    std::printf("%-40s delay %.2f ms, lag %.2f ms, gain %.2f %%, dead zone %.2f mm/s, wheel base %.2f mm (RMS of %d)\n",
                drive.name, 1e3 * std::sqrt(squares.delay_s), 1e3 * std::sqrt(squares.lag_s),
                1e2 * std::sqrt(squares.gain_left), 1e3 * std::sqrt(squares.dead_zone_mps),
                1e3 * std::sqrt(squares.wheel_base_m), seeds);
    EXPECT_LT(std::sqrt(squares.delay_s), 0.003) << drive.name;
    EXPECT_LT(std::sqrt(squares.lag_s), 0.010) << drive.name;
    EXPECT_LT(std::sqrt(squares.gain_left), 0.01) << drive.name;
  }
}

TEST(DriveEstimator, FindsSwappedAndReversedWheels) {
  const DriveCase drive{"", 0.04, 0.08, 0.0, 0.0};
  const hal::mock::ArenaParameters arena = arena_of(drive);
  for (const bool is_swapped : {false, true}) {
    for (const bool left_is_reversed : {false, true}) {
      for (const bool right_is_reversed : {false, true}) {
        const WheelWiring wiring{is_swapped, {left_is_reversed, right_is_reversed}};
        SimulatedMeasurement measurement(arena, {}, 4);
        measurement.wiring = wiring;
        measurement.run(10.0);
        measurement.estimator.solve();
        const DriveEstimate& measured = measurement.estimator.estimate();
        EXPECT_TRUE(measured.is_wiring_known);
        EXPECT_EQ(measured.wiring, wiring) << is_swapped << left_is_reversed << right_is_reversed;
        EXPECT_NEAR(measured.delay_s.value, drive.delay_s, 0.005);
      }
    }
  }
}

TEST(DriveEstimator, KnowsNothingOfARobotThatStands) {
  SimulatedMeasurement measurement(arena_of({"", 0.04, 0.08, 0.0, 0.0}), {}, 1);
  measurement.stands = true;
  measurement.run(kMeasured_s);
  measurement.estimator.solve();
  const DriveEstimate& measured = measurement.estimator.estimate();
  EXPECT_FALSE(measured.is_wiring_known);
  EXPECT_FALSE(measured.delay_s.is_known);
  EXPECT_FALSE(measured.gain_left.is_known);
}

TEST(DriveEstimator, KnowsLessAfterAShortTime) {
  SimulatedMeasurement measurement(arena_of({"", 0.04, 0.08, 0.0, 0.0}), {}, 1);
  measurement.run(0.5);
  measurement.estimator.solve();
  EXPECT_FALSE(measurement.estimator.estimate().delay_s.is_known);
  measurement.run(3.0);
  measurement.estimator.solve();
  const DriveEstimate early = measurement.estimator.estimate();
  EXPECT_FALSE(early.gain_left.is_known);
  measurement.run(16.0);
  measurement.estimator.solve();
  const DriveEstimate& late = measurement.estimator.estimate();
  EXPECT_LT(late.delay_s.sigma, early.delay_s.sigma);
  EXPECT_LT(late.gain_left.sigma, 0.7 * early.gain_left.sigma);
}

TEST(DriveEstimator, WorksInPartsWhileTheRecordGrows) {
  const DriveCase drive{"", 0.06, 0.08, 0.0, 0.0};
  SimulatedMeasurement measurement(arena_of(drive), {}, 2);
  // Longer than the record, so that entries are overwritten while they are read.
  for (int frame = 0; frame < 60 * 40; ++frame) {
    measurement.run(1.0 / 60.0);
    std::size_t intervals = 200;
    static_cast<void>(measurement.estimator.work(intervals));
  }
  const DriveEstimate& measured = measurement.estimator.estimate();
  EXPECT_TRUE(measured.delay_s.is_known);
  EXPECT_NEAR(measured.delay_s.value, drive.delay_s, 0.003);
  EXPECT_NEAR(measured.lag_s.value, drive.lag_s, 0.005);
  EXPECT_GT(measured.intervals, 1500U);
}

// Friction that holds the wheels at low speeds, and nothing else, is no part of the model.
TEST(DriveEstimator, BearsStiction) {
  const DriveCase drive{"", 0.06, 0.08, 0.0, 0.0};
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulatedMeasurement measurement(arena_of(drive), {}, seed);
    measurement.stiction_mps = 0.06;
    measurement.run(kMeasured_s);
    measurement.estimator.solve();
    const DriveEstimate& measured = measurement.estimator.estimate();
    const Errors errors = errors_of(measured, drive, measurement.world().motors(0), 0.07);
    EXPECT_LT(std::abs(errors.delay_s), 0.003);
    EXPECT_LT(std::abs(errors.lag_s), 0.010);
    EXPECT_LT(std::abs(errors.gain_left), 0.02);
    EXPECT_LT(std::abs(errors.gain_right), 0.02);
  }
}

}  // namespace
}  // namespace touchline
