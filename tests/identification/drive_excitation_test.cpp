#include "core/identification/drive_excitation.h"

#include <gtest/gtest.h>

#include "tests/identification/simulated_measurement.h"

namespace touchline {
namespace {

TEST(DriveExcitation, KeepsItsLimits) {
  const ExcitationLimits limits;
  DriveExcitation excitation(limits, 5);
  excitation.set_wiring({});
  WheelSpeeds before;
  for (int frame = 0; frame < 2000; ++frame) {
    // A robot that does not move: the pattern does not depend on success.
    const WheelSpeeds wheels = excitation.next({}, Instant{} + std::chrono::milliseconds(16 * frame));
    for (const auto& [now, last] :
         {std::pair{wheels.left_mps, before.left_mps}, {wheels.right_mps, before.right_mps}}) {
      EXPECT_LE(std::abs(now), static_cast<float>(limits.max_speed_mps) + 1e-6f);
      EXPECT_LE(std::abs(now - last), static_cast<float>(limits.max_step_mps) + 1e-6f);
    }
    before = wheels;
  }
}

TEST(DriveExcitation, StaysNearThePlaceOfTheStart) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    hal::mock::ArenaParameters arena = hal::mock::noise_free_arena();
    arena.radio.delay_s = 0.12;
    arena.physics.wheel_lag_s = 0.16;
    arena.physics.wheel_slip = 0.03;
    SimulatedMeasurement measurement(arena, {}, seed);
    measurement.run(20.0);
    // The way that the robot drives before it obeys comes in addition to the radius.
    EXPECT_GT(measurement.farthest_m(), 0.1);
    EXPECT_LT(measurement.farthest_m(), ExcitationLimits().radius_m + 0.1);
  }
}

}  // namespace
}  // namespace touchline
