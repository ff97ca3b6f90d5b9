#include "tools/programs/radio/drive_measurement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/angle.h"
#include "firmware/config/configuration.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/mock/mock_game.h"
#include "tools/programs/radio/measured_files.h"

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

// Drives robot 1 with both wheels at 0.4 m/s, among robots that stand. Its wheels do not slip, so only the gains turn
// it.
class StraightDrive : public MockGame {
 public:
  StraightDrive(std::uint64_t seed, const std::string& wheel_gain)
      : MockGame(seed, {},
                 with_measuring({"arena.opponents=stand", kUnequalWheels, "arena.physics.wheel_slip=0",
                                 "arena.physics.floor_roughness_mps_rts=0", "own.robot[1].wheel_gain=" + wheel_gain})) {
    LoopSettings wanted = settings();
    wanted.external.commands = &commands_;
    LoopObserver observer;
    observer.context = this;
    observer.on_step = [](void* context, const StepTrace& trace, const StepTiming&) {
      static_cast<StraightDrive*>(context)->look(trace);
    };
    open(loop, *camera, *radio, *gpio, wanted, observer);
  }

  void run() {
    const double before_rad = robot().theta_rad;
    while (frames_ < 120) ASSERT_FALSE(loop->iterate().has_value());
    turned_rad = wrap_angle(robot().theta_rad - before_rad);
    const std::array<double, 2> way{robot().x_m - begin_.x_m, robot().y_m - begin_.y_m};
    way_m = std::hypot(way[0], way[1]);
  }

  static constexpr const char* kUnequalWheels = "arena.physics.wheel_error=0.15";
  double turned_rad = 0.0, way_m = 0.0;
  double commanded_m = 0.0;

 private:
  [[nodiscard]] hal::mock::Placement robot() const { return arena->world().snapshot().robots[1]; }

  void look(const StepTrace& trace) {
    ++frames_;
    if (frames_ == 1) begin_ = robot();
    ExternalCommand command;
    command.id = 1;
    command.kind = ExternalCommand::Kind::kWheels;
    if (frames_ > 40 && frames_ < 100) command.wheels = {0.4f, 0.4f};
    command.received = hal::MonotonicClock::read() + std::chrono::hours(1);  // counts as now
    ExternalCommands commands;
    commands.push_back(command);
    commands_.put(commands);
    for (const RobotCommand& sent : trace.commands.robots) {
      if (sent.id == 1) commanded_m += 0.5 * static_cast<double>(sent.wheels.left_mps + sent.wheels.right_mps) / 60.0;
    }
  }

  Mailbox<ExternalCommands> commands_;
  int frames_ = 0;
  hal::mock::Placement begin_;

 public:
  std::optional<Loop> loop;
};

std::string gains_text(const std::array<double, 2>& gain) {
  return "[" + std::to_string(gain[0]) + ", " + std::to_string(gain[1]) + "]";
}

TEST(DriveMeasurementInArena, ARobotWithKnownGainsDrivesStraight) {
  constexpr std::uint64_t kSeed = 3;
  StraightDrive as_it_is(kSeed, "[1, 1]");
  as_it_is.run();
  StraightDrive corrected(kSeed, gains_text(as_it_is.arena->world().motors(1).gain));
  corrected.run();
  EXPECT_GT(std::abs(as_it_is.turned_rad), 0.3);
  EXPECT_LT(std::abs(corrected.turned_rad), 0.02);
  // Tracker and prediction read the commands, so these must be what the robot drives. The dead zone takes 2 mm.
  EXPECT_NEAR(corrected.way_m, corrected.commanded_m, 0.004);
  EXPECT_GT(std::abs(as_it_is.way_m - as_it_is.commanded_m), 0.02);
}

TEST(DriveMeasurementInArena, FindsTheGainsWithWhichARobotDrivesStraight) {
  constexpr std::uint64_t kSeed = 3;
  MeasuredGame game(kSeed, {"arena.opponents=stand", StraightDrive::kUnequalWheels, "own.robot[1].wheel_gain=[0.9, 1]"},
                    1);
  EXPECT_EQ(game.run(), LoopEnd::kRestart);
  game.measurement.estimator().solve();
  const std::vector<MeasuredKey> keys = measured_keys(game.measurement.estimator().estimate(), 1, *game.configuration);
  ASSERT_FALSE(keys.empty());
  ASSERT_EQ(keys.back().key, "wheel_gain");
  const std::array<double, 2> truth = game.arena->world().motors(1).gain;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(keys.back().numbers[i].measured, truth[i], 0.01) << "sigma " << keys.back().numbers[i].sigma;
  }
  StraightDrive corrected(kSeed, keys.back().text());
  corrected.run();
  EXPECT_LT(std::abs(corrected.turned_rad), 0.05) << "a gain is wrong by less than 1 %";
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
