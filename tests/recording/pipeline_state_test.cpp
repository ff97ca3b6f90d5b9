// The recorded state is complete: a second pipeline that gets it in the middle of a game makes the same tracks,
// commands and packets from then on, with the sightings of the first one.
#include "firmware/recording/pipeline_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "firmware/recording/step_message.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/mock/mock_game.h"

namespace touchline::testing {
namespace {

using namespace recording;
using hal::mock::FaultKind;

/// A game whose steps a second pipeline repeats. It gets the first one's state after every `period`-th step, and then
/// is one that knows nothing else.
class ResumedGame : public MockGame {
 public:
  explicit ResumedGame(std::vector<hal::mock::ArenaFault> faults, std::vector<std::string> overrides = {},
                       int period = 20)
      : MockGame(1, std::move(faults), std::move(overrides)), period_(period) {
    LoopSettings wanted = settings();
    wanted.external.commands = &commands;
    wanted.external.referee = &referee;
    wanted.external.own_is_yellow = true;
    LoopObserver observer{&ResumedGame::on_step, this};
    observer.on_stop = &ResumedGame::on_stop;
    open(loop, *camera, *radio, *gpio, wanted, observer);
  }

  void run_until(double end_s) {
    while (now_s() < end_s) ASSERT_FALSE(loop->iterate().has_value());
  }
  void put_command(float x_m) {
    ExternalCommand command;
    command.id = 2;
    command.kind = ExternalCommand::Kind::kPose;
    command.target = {{x_m, 0.1f}, 1.0f};
    command.has_heading = true;
    command.received = hal::MonotonicClock::read();
    ExternalCommands table;
    table.push_back(command);
    commands.put(table);
  }
  void put_teams(bool own_is_yellow, bool own_on_positive_half) {
    RefereeState state;
    state.own_is_yellow = own_is_yellow;
    state.own_on_positive_half = own_on_positive_half;
    state.received = hal::MonotonicClock::read();
    referee.put(state);
  }

  Mailbox<ExternalCommands> commands;
  Mailbox<RefereeState> referee;
  std::array<int, kResultParts> differences{};
  int compared = 0, moving = 0, exchanged = 0, states = 0, stops = 0, corrected_wheels = 0, corrected_lag = 0,
      corrected_delay = 0;
  std::size_t largest = 0;

 private:
  void compare(const StepResults& one, const StepResults& other) {
    if (states == 0) return;
    ++compared;
    for (std::size_t i = 0; i < kResultParts; ++i) differences[i] += one[i] == other[i] ? 0 : 1;
  }
  void add(const StepTrace& trace) {
    const DriveCorrections& drives = pipeline->drive_corrections();
    corrected_wheels += drives.wheels.empty() ? 0 : 1;
    corrected_lag += drives.lag_s ? 1 : 0;
    corrected_delay += drives.more_delay != Duration::zero() ? 1 : 0;
    moving += trace.commands.stop ? 0 : 1;
    exchanged += trace.inputs->teams.colors_exchanged && trace.inputs->teams.sides_exchanged ? 1 : 0;
    StepResults first, second;
    write_results(trace.sightings, trace.tracks, trace.commands, trace.packets, first);
    if (states > 0) {
      // As a replay gets them.
      *sightings_ = trace.sightings;
      if (trace.inputs->teams.colors_exchanged) {
        for (RobotSighting& robot : sightings_->robots)
          robot.team = robot.team == Team::kOwn ? Team::kOpponent : Team::kOwn;
      }
      Frame frame = trace.frame;
      frame.sightings = sightings_.get();
      StepInputs inputs = *trace.inputs;
      inputs.was_unusable = trace.picture.is_unusable();
      inputs.drives = drives;
      const StepTrace& repeated = second_->step(frame, inputs);
      if (trace.revoked) second_->revoke();
      write_results(repeated.sightings, repeated.tracks, repeated.commands, repeated.packets, second);
      second_->adapt();
      compare(first, second);
    }
    pass_state();
  }
  void pass_state() {
    if (++steps_ % period_ != 0) return;
    write_state(*pipeline, *state_);
    ASSERT_TRUE(state_->fits());
    largest = std::max(largest, state_->bytes().size());
    second_ = std::make_unique<Pipeline>();
    ASSERT_TRUE(second_->configure(configuration->pipeline).ok());
    const Result<void> read = read_state(state_->bytes(), *second_);
    ASSERT_TRUE(read.ok()) << read.text();
    ++states;
  }
  static void on_step(void* context, const StepTrace& trace, const StepTiming&) {
    static_cast<ResumedGame*>(context)->add(trace);
  }
  static void on_stop(void* context, const StepInputs& inputs) {
    auto& game = *static_cast<ResumedGame*>(context);
    ++game.stops;
    if (game.states == 0) return;
    StepInputs with_drives = inputs;
    with_drives.drives = game.pipeline->drive_corrections();
    // The numbers of the next packets tell whether this one was made, too.
    EXPECT_FALSE(game.second_->stop(with_drives).empty());
  }

  const int period_;
  int steps_ = 0;
  std::unique_ptr<Pipeline> second_;
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
  std::unique_ptr<StateBytes> state_ = std::make_unique<StateBytes>();

 public:
  std::optional<Loop> loop;  // the last member: its end sends stops
};

void expect_no_differences(const ResumedGame& game) { EXPECT_EQ(game.differences, (std::array<int, kResultParts>{})); }

TEST(PipelineState, AGameGoesOnAfterIt) {
  ResumedGame game({{FaultKind::kCameraLost, 3.0, 0.3},
                    {FaultKind::kEmergencyStop, 4.0, 0.3},
                    {FaultKind::kStartButton, 4.6, 0.1},
                    {FaultKind::kRadioLost, 6.0, 0.2}});
  game.run_until(16.0);
  expect_no_differences(game);
  EXPECT_GT(game.compared, 800);
  EXPECT_GT(game.moving, 700);
  EXPECT_GT(game.states, 40);
  EXPECT_GT(game.stops, 2);
  EXPECT_GT(game.largest, 8000U);
  EXPECT_LT(game.largest, 30000U) << "see kMaxStateBytes";
}

// Another program sends a robot through the others, there and back.
TEST(PipelineState, TheWayToAPoseGoesOnAfterIt) {
  ResumedGame game({}, {}, 7);
  while (game.now_s() < 5.0) {
    game.put_command(std::fmod(game.now_s(), 2.5) < 1.25 ? 0.7f : -0.7f);
    game.run_until(game.now_s() + 0.02);
  }
  expect_no_differences(game);
  EXPECT_GT(game.moving, 200);
}

TEST(PipelineState, TheAssignmentOfTeamsGoesOnAfterIt) {
  ResumedGame game({});
  game.run_until(1.0);
  game.put_teams(false, true);
  game.run_until(1.6);
  game.put_teams(true, false);
  game.run_until(2.2);
  expect_no_differences(game);
  EXPECT_GT(game.exchanged, 20);
}

// The second pipeline has measured nothing: what the first one has measured is an input.
TEST(PipelineState, WhatTheMeasuredDrivesChangeIsRepeated) {
  ResumedGame game(
      {}, {"arena.radio.delay_s=0.057", "arena.physics.wheel_lag_s=0.12", "arena.physics.wheel_error=0.15"}, 100);
  game.run_until(40.0);
  expect_no_differences(game);
  EXPECT_GT(game.corrected_delay, 200);
  EXPECT_GT(game.corrected_lag, 200);
  EXPECT_GT(game.corrected_wheels, 200);
}

}  // namespace
}  // namespace touchline::testing
