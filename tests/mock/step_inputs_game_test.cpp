// The inputs of a game's steps are complete: a second pipeline that gets the loop's frames and inputs computes the same
// traces, with faults, a reload, a referee and commands of another program.
#include <gtest/gtest.h>

#include <optional>

#include "hal/linux/monotonic_clock.h"
#include "tests/mock/mock_game.h"
#include "tests/pipeline/trace_digest.h"

namespace touchline {
namespace {

using hal::mock::FaultKind;
using testing::TraceDigest;

/// A game whose steps a second pipeline repeats.
struct RepeatedGame : public MockGame {
  explicit RepeatedGame(std::vector<hal::mock::ArenaFault> faults) : MockGame(1, std::move(faults)) {
    EXPECT_TRUE(second->configure(configuration->pipeline).ok());
    LoopSettings changed = settings();
    changed.external.commands = &commands;
    changed.external.referee = &referee;
    changed.external.own_is_yellow = true;
    changed.adaptation = &adaptation;
    changed.live_update = &live_update;
    LoopObserver observer{&RepeatedGame::on_step, this};
    observer.on_stop = &RepeatedGame::on_stop;
    open(loop, *camera, *radio, *gpio, changed, observer);
  }

  void run_until(double end_s) {
    while (now_s() < end_s) ASSERT_FALSE(loop->iterate().has_value());
  }
  void put_command() {
    ExternalCommand command;
    command.id = 2;
    command.twist = {0.2f, 4.0f};
    command.received = hal::MonotonicClock::read();
    ExternalCommands table;
    table.push_back(command);
    commands.put(table);
  }
  void put(bool own_is_yellow, bool own_on_positive_half) {
    RefereeState state;
    state.own_is_yellow = own_is_yellow;
    state.own_on_positive_half = own_on_positive_half;
    state.received = hal::MonotonicClock::read();
    referee.put(state);
  }

  std::unique_ptr<Pipeline> second = std::make_unique<Pipeline>();
  Mailbox<ExternalCommands> commands;
  Mailbox<RefereeState> referee;
  AdaptationRequests adaptation;
  LiveUpdate live_update;
  std::optional<Loop> loop;
  bool forgets_commands = false;  // the second pipeline does not get the commands of the other program
  int steps = 0, stops = 0, differences = 0;
  // Numbers of steps and stops with these inputs.
  int acknowledged = 0, opened = 0, reset = 0, reloads = 0, modes = 0, telemetry = 0, revoked = 0, external = 0,
      halted = 0, exchanged = 0;

 private:
  void count(const StepInputs& inputs) {
    const StepEvents& events = inputs.events;
    acknowledged += events.picture_acknowledged ? 1 : 0;
    opened += events.radio_opened ? 1 : 0;
    reset += events.reset ? 1 : 0;
    reloads += events.control ? 1 : 0;
    modes += events.adaptation_mode ? 1 : 0;
    telemetry += events.telemetry.empty() ? 0 : 1;
    external += inputs.commands.empty() ? 0 : 1;
    halted += inputs.halt != 0 ? 1 : 0;
    exchanged += inputs.teams.colors_exchanged && inputs.teams.sides_exchanged ? 1 : 0;
  }
  void compare(std::uint64_t one, std::uint64_t other) { differences += one == other ? 0 : 1; }
  static void on_step(void* context, const StepTrace& trace, const StepTiming&) {
    auto& game = *static_cast<RepeatedGame*>(context);
    ++game.steps;
    game.count(*trace.inputs);
    game.revoked += trace.revoked ? 1 : 0;
    StepInputs inputs = *trace.inputs;
    if (game.forgets_commands) inputs.commands.clear();
    const StepTrace& repeated = game.second->step(trace.frame, inputs);
    if (trace.revoked) game.second->revoke();
    game.second->adapt();
    TraceDigest first, second;
    first.add(trace);
    second.add(repeated);
    game.compare(first.value(), second.value());
  }
  static void on_stop(void* context, const StepInputs& inputs) {
    auto& game = *static_cast<RepeatedGame*>(context);
    ++game.stops;
    game.count(inputs);
    TraceDigest packets;
    packets.add(game.second->stop(inputs));
    EXPECT_NE(packets.value(), TraceDigest().value());
  }
};

TEST(StepInputsGame, FramesAndInputsRepeatEveryTrace) {
  RepeatedGame game({{FaultKind::kCameraLost, 1.0, 0.3},
                     {FaultKind::kRadioLost, 1.8, 0.2},
                     {FaultKind::kEmergencyStop, 2.4, 0.2},
                     {FaultKind::kStartButton, 2.8, 0.1}});
  game.run_until(0.3);
  game.put_command();
  game.adaptation.freeze.fetch_add(1);
  game.run_until(0.8);
  const auto reloaded = std::make_unique<LiveSettings>();
  reloaded->control = game.configuration->pipeline.control;
  reloaded->control.drive.max_speed_mps /= 2;
  reloaded->faults = game.configuration->board.faults;
  reloaded->radio_delay = std::chrono::milliseconds(25);
  game.live_update.offer(*reloaded);
  game.run_until(1.6);
  EXPECT_FALSE(game.live_update.is_pending());
  game.put(false, true);
  game.run_until(1.7);
  game.put(true, false);
  game.run_until(3.5);

  EXPECT_EQ(game.differences, 0);
  EXPECT_GT(game.steps, 100);
  EXPECT_GT(game.stops, 2);
  EXPECT_EQ(game.acknowledged, 1);
  EXPECT_EQ(game.opened, 1);
  EXPECT_EQ(game.reset, 1);
  EXPECT_EQ(game.reloads, 1);
  EXPECT_EQ(game.modes, 1);
  EXPECT_GT(game.telemetry, 5);
  EXPECT_GT(game.external, 100);
  EXPECT_GT(game.halted, 10);
  EXPECT_GT(game.exchanged, 3);
}

TEST(StepInputsGame, APlantedForgottenInputIsFound) {
  RepeatedGame game({});
  game.forgets_commands = true;
  game.run_until(0.3);
  EXPECT_EQ(game.differences, 0);
  game.put_command();
  game.run_until(0.4);
  EXPECT_GT(game.differences, 0);
}

}  // namespace
}  // namespace touchline
