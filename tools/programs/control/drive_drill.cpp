#include "tools/programs/control/drive_drill.h"

#include <cmath>
#include <memory>

#include "firmware/arena_sides.h"
#include "hal/mock/game.h"
#include "hal/mock/simulated_side.h"

namespace touchline::control_evaluation {

using hal::mock::Side;

namespace {

constexpr double kDelayAfter_s = 10.0, kAllAfter_s = 30.0;

DriveReports& reports_of(void* context) { return *static_cast<DriveReports*>(context); }

double in_sigmas(double error, const MeasuredValue& value) { return error / value.sigma; }

void compare_wheels(const DriveReports& measured, const hal::mock::World& world, DriveErrors& errors) {
  double square = 0.0, sigmas_square = 0.0;
  for (std::size_t i = 0; i < world.robots(); ++i) {
    if (world.side(i) != Side::kOwn) continue;
    ++errors.robots;
    for (const RobotDrive& drive : measured.robots) {
      const auto& [left, right] = drive.gain;
      if (drive.id != world.id(i) || !left.measured.is_known || !right.measured.is_known) continue;
      ++errors.known_robots;
      for (std::size_t wheel = 0; wheel < 2; ++wheel) {
        const MeasuredValue& gain = drive.gain[wheel].measured;
        const double error = gain.value - world.motors(i).gain[wheel];
        square += error * error;
        sigmas_square += in_sigmas(error, gain) * in_sigmas(error, gain);
      }
    }
  }
  const double wheels = 2.0 * errors.known_robots;
  if (errors.known_robots == 0) return;
  errors.gain = std::sqrt(square / wheels);
  errors.gain_sigmas = std::sqrt(sigmas_square / wheels);
}

}  // namespace

Result<DriveErrors> drive_drill(const config::Configuration& configuration, const DriveTruth& truth,
                                std::uint64_t seed) {
  config::Configuration changed = configuration;
  hal::mock::ArenaParameters& arena = changed.board.arena;
  arena.radio.delay_s = truth.delay_s - truth.jitter_s;
  arena.radio.jitter_s = truth.jitter_s;
  arena.radio.loss = truth.loss;
  arena.physics.wheel_lag_s = truth.lag_s;
  arena.physics.wheel_error = truth.wheel_error;
  arena.physics.wheel_slip = truth.slip;
  changed.board.camera.rate_hz = truth.rate_hz;
  hal::mock::Game game(arena, changed.board.radio, seed);
  game.channel(Side::kOwn).set_layouts(changed.pipeline.radio, changed.pipeline.telemetry);
  std::array<std::unique_ptr<hal::mock::SimulatedSide>, 2> sides;
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    auto& player = sides[static_cast<std::size_t>(side)];
    player = std::make_unique<hal::mock::SimulatedSide>(arena, side, seed);
    if (const Status status = player->configure(side_settings(changed, side)); !status.ok()) {
      return failure(status.code(), "the pipeline of a side refuses the settings");
    }
    game.set_side(side, player.get());
  }
  DriveReports measured;
  sides[0]->set_observer([](void* context, const StepTrace& trace) { reports_of(context) = trace.drives; }, &measured);

  DriveErrors errors;
  game.advance_to(game.begin() + from_seconds(kDelayAfter_s));
  errors.is_delay_known = measured.delay_s.measured.is_known;
  errors.delay_s = measured.delay_s.measured.value - truth.delay_s;
  errors.delay_sigmas = in_sigmas(errors.delay_s, measured.delay_s.measured);
  game.advance_to(game.begin() + from_seconds(kAllAfter_s));
  errors.is_lag_known = measured.lag_s.measured.is_known;
  errors.lag_s = measured.lag_s.measured.value - truth.lag_s;
  errors.lag_sigmas = in_sigmas(errors.lag_s, measured.lag_s.measured);
  compare_wheels(measured, game.world(), errors);
  return errors;
}

}  // namespace touchline::control_evaluation
