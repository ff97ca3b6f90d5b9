#include "tools/programs/radio/drive_measurement.h"

#include <gtest/gtest.h>

#include "firmware/config/configuration.h"
#include "tests/mock/mock_game.h"

// Measures robots of the arena by its pictures, through the whole loop.
namespace touchline::radio {
namespace {

std::vector<std::string> with_measuring(std::vector<std::string> overrides) {
  for (std::string& wanted : measuring_overrides()) overrides.push_back(std::move(wanted));
  return overrides;
}

class MeasuredGame : public MockGame {
 public:
  MeasuredGame(std::uint64_t seed, std::vector<std::string> overrides, RobotId robot,
               std::vector<hal::mock::ArenaFault> faults = {}, double duration_s = 23.0)
      : MockGame(seed, std::move(faults), with_measuring(std::move(overrides))),
        measurement(settings_for(robot, duration_s)) {
    LoopSettings wanted = settings();
    wanted.external.commands = &measurement.commands();
    wanted.restart = &measurement.has_ended();
    LoopObserver observer;
    observer.context = &measurement;
    observer.on_step = [](void* context, const StepTrace& trace, const StepTiming& timing) {
      static_cast<DriveMeasurement*>(context)->on_step(trace, timing);
    };
    open(loop, *camera, *radio, *gpio, wanted, observer);
  }

  LoopEnd run() { return loop->run(stop); }

 private:
  [[nodiscard]] MeasurementSettings settings_for(RobotId robot, double duration_s) const {
    MeasurementSettings out;
    out.robot = robot;
    out.duration_s = duration_s;
    out.expected.delay_s = configuration->board.radio.delay_s;
    out.field = configuration->pipeline.marker.field;
    out.radio_line = hal::line_time(configuration->board.radio);
    return out;
  }

  std::atomic<bool> stop{false};

 public:
  DriveMeasurement measurement;
  std::optional<Loop> loop;
};

double energy_of(const hal::mock::Arena& arena) { return arena.world().energy(); }

TEST(DriveMeasurementInArena, FindsWhatTheFilesDoNotSay) {
  constexpr double kDelay_s = 0.057, kLag_s = 0.12, kDeadZone_mps = 0.03;
  MeasuredGame game(3,
                    {"arena.opponents=stand", "arena.radio.delay_s=0.057", "arena.physics.wheel_lag_s=0.12",
                     "arena.physics.wheel_dead_zone_mps=0.03"},
                    1);
  EXPECT_EQ(game.run(), LoopEnd::kRestart);
  ASSERT_EQ(game.measurement.end(), DriveMeasurement::End::kDone) << describe(game.measurement.end());
  game.measurement.estimator().solve();
  const DriveEstimate& measured = game.measurement.estimator().estimate();
  const hal::mock::World::Motors motors = game.arena->world().motors(1);
  EXPECT_EQ(measured.wiring, WheelWiring());
  EXPECT_TRUE(measured.delay_s.is_known);
  EXPECT_NEAR(measured.delay_s.value, kDelay_s + game.configuration->board.arena.radio.jitter_s, 0.003);
  EXPECT_NEAR(measured.lag_s.value, kLag_s, 0.010);
  EXPECT_NEAR(measured.gain_left.value, motors.gain[0], 0.02);
  EXPECT_NEAR(measured.gain_right.value, motors.gain[1], 0.02);
  EXPECT_NEAR(measured.dead_zone_mps.value, kDeadZone_mps, 0.004);
  EXPECT_NEAR(measured.wheel_base_m.value, 0.07, 0.001);
  game.arena->advance_to(game.arena->now() + std::chrono::seconds(1));
  EXPECT_LT(energy_of(*game.arena), 1e-6) << "all robots stand at the end";
}

TEST(DriveMeasurementInArena, FindsWrongWiring) {
  MeasuredGame game(
      1, {"arena.opponents=stand", "arena.physics.wheels_exchanged=true", "arena.physics.left_reversed=true"}, 1, {},
      6.0);
  EXPECT_EQ(game.run(), LoopEnd::kRestart);
  EXPECT_EQ(game.measurement.end(), DriveMeasurement::End::kDone) << describe(game.measurement.end());
  const DriveEstimate& measured = game.measurement.estimator().estimate();
  EXPECT_TRUE(measured.is_wiring_known);
  EXPECT_EQ(measured.wiring, (WheelWiring{true, {true, false}}));
}

TEST(DriveMeasurementInArena, NeedsRoom) {
  MeasuredGame game(1, {"arena.opponents=stand"}, 0);
  EXPECT_EQ(game.run(), LoopEnd::kRestart);
  EXPECT_EQ(game.measurement.end(), DriveMeasurement::End::kNoRoom);
}

TEST(DriveMeasurementInArena, EndsIfTheRobotIsNotSeen) {
  MeasuredGame game(1, {"arena.opponents=stand"}, 9);
  EXPECT_EQ(game.run(), LoopEnd::kRestart);
  EXPECT_EQ(game.measurement.end(), DriveMeasurement::End::kNotSeen);
}

TEST(DriveMeasurementInArena, StopsWithTheEmergencyStop) {
  MeasuredGame game(1, {"arena.opponents=stand"}, 1, {{hal::mock::FaultKind::kEmergencyStop, 4.0, 100.0}});
  EXPECT_EQ(game.run(), LoopEnd::kRestart);
  EXPECT_EQ(game.measurement.end(), DriveMeasurement::End::kHalted);
  EXPECT_LT(energy_of(*game.arena), 1e-6);
}

}  // namespace
}  // namespace touchline::radio
