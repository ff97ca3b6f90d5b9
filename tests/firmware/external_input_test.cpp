// Commands of other programs and messages of a referee, from their mailboxes to the robots.
#include "firmware/external_input.h"

#include <algorithm>

#include "firmware/status_text.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/firmware/loop_fixture.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

Instant at(double s) { return Instant(from_seconds(1000.0 + s)); }
Instant machine(double s) { return Instant(from_seconds(77.0 + s)); }
// A time of reception in the future counts as the time at which the loop takes the value, which gives exact ages on the
// fake clock.
Instant when_taken() { return hal::MonotonicClock::read() + 1h; }

ExternalCommand turn_robot(RobotId id, Instant received) {
  ExternalCommand command;
  command.id = id;
  command.twist = {0.0f, 3.0f};
  command.received = received;
  return command;
}

TEST(ExternalInput, AnAgeIsTheSameOnBothClocks) {
  Mailbox<ExternalCommands> mailbox;
  ExternalInput input({&mailbox, nullptr, {}});
  ExternalCommands table;
  table.push_back(turn_robot(3, machine(0.98)));
  table.push_back(turn_robot(1, machine(1.5)));
  mailbox.put(table);
  input.take(at(5.0), machine(1.0));
  ASSERT_EQ(input.commands().size(), 2U);
  EXPECT_EQ(input.commands()[0].received, at(4.98));
  EXPECT_EQ(input.commands()[1].received, at(5.0)) << "stamped in the future";
  input.take(at(6.0), machine(1.1));
  EXPECT_EQ(input.commands()[0].received, at(4.98)) << "nothing new";
  EXPECT_EQ(input.counts().commands, 2U);
}

TEST(ExternalInput, ACommandGrowsOldWhileOtherRobotsGetNewOnes) {
  Mailbox<ExternalCommands> mailbox;
  ExternalInput input({&mailbox, nullptr, {}});
  ExternalCommands table;
  table.push_back(turn_robot(3, machine(1.0)));
  mailbox.put(table);
  input.take(at(5.0), machine(1.0));
  // A fast simulation: 0.5 s of simulated time in 10 ms.
  ExternalCommands next;
  next.push_back(turn_robot(4, machine(1.01)));
  next.push_back(table[0]);
  mailbox.put(next);
  input.take(at(5.5), machine(1.01));
  EXPECT_EQ(input.commands()[0].received, at(5.5));
  EXPECT_EQ(input.commands()[1].received, at(5.0));
  EXPECT_EQ(input.counts().commands, 2U);
}

TEST(ExternalInput, CountsHowOftenACommandBecameTooOld) {
  ExternalInput input({});
  Commands commands;
  commands.robots.push_back({1, {}, {}, CommandSource::kExternal});
  commands.robots.push_back({2, {}, {}, CommandSource::kExpired});
  for (int i = 0; i < 3; ++i) input.count_expired(commands);
  EXPECT_EQ(input.counts().commands_expired, 1U);
  commands.robots[0].source = CommandSource::kExpired;
  commands.robots[1].source = CommandSource::kExternal;
  input.count_expired(commands);
  commands.robots[1].source = CommandSource::kExpired;
  input.count_expired(commands);
  EXPECT_EQ(input.counts().commands_expired, 3U);
}

TEST(ExternalInput, OnlyARefereeThatRepeatsItsMessagesStopsRobotsBySilence) {
  Mailbox<RefereeState> mailbox;
  ExternalInput input({nullptr, &mailbox, {}});
  EXPECT_EQ(input.halt(at(0.0), 1s), kHaltNone) << "no referee";
  RefereeState state;
  state.phase = GamePhase::kRunning;
  state.received = machine(0.9);
  mailbox.put(state);
  input.take(at(1.0), machine(1.0));
  EXPECT_EQ(input.halt(at(1000.0), 1s), kHaltNone);
  state.repeats = true;
  mailbox.put(state);
  input.take(at(1.0), machine(1.0));
  EXPECT_EQ(input.halt(at(1.9), 1s), kHaltNone);
  EXPECT_EQ(input.halt(at(1.9) + 1us, 1s), kHaltSilence);
  for (const GamePhase phase : {GamePhase::kHalt, GamePhase::kStop, GamePhase::kPrepare}) {
    state.phase = phase;
    mailbox.put(state);
    input.take(at(2.0), machine(1.0));
    EXPECT_EQ(input.halt(at(2.0), 1s), kHaltReferee);
  }
  EXPECT_EQ(input.counts().referee_messages, 5U);
}

TEST(ExternalInput, RobotsLineUpWhereTheLeagueLetsThemButNeverInAHalt) {
  Mailbox<RefereeState> mailbox;
  ExternalInput input({nullptr, &mailbox, {}});
  RefereeState state;
  state.lines_up = true;
  state.restart = Restart::kKickOff;
  state.restart_is_ours = true;
  for (const GamePhase phase : {GamePhase::kHalt, GamePhase::kStop, GamePhase::kPrepare, GamePhase::kRunning}) {
    state.phase = phase;
    mailbox.put(state);
    input.take(at(1.0), machine(1.0));
    EXPECT_EQ(input.halt(at(1.0), 1s), phase == GamePhase::kHalt ? kHaltReferee : kHaltNone);
    EXPECT_EQ(input.referee().situation(), (GameSituation{phase, Restart::kKickOff, true, true}));
  }
}

TEST(ExternalInput, ASimulatedRefereeIsObeyedUnlessThereIsAnotherOne) {
  RefereeState simulated;
  simulated.phase = GamePhase::kPrepare;
  simulated.own_on_positive_half = true;
  ExternalInputSettings settings;
  settings.simulated_referee = {[](void* state) { return std::optional(*static_cast<const RefereeState*>(state)); },
                                &simulated};
  ExternalInput input(settings);
  input.take(at(1.0), machine(1.0));
  EXPECT_EQ(input.halt(at(1.0), 1s), kHaltReferee);
  EXPECT_EQ(input.referee().own_on_positive_half, true);
  simulated.phase = GamePhase::kRunning;
  input.take(at(2.0), machine(2.0));
  EXPECT_EQ(input.halt(at(100.0), 1s), kHaltNone);
  EXPECT_EQ(input.counts().referee_messages, 0U);
  Mailbox<RefereeState> mailbox;
  settings.referee = &mailbox;
  ExternalInput with_other(settings);
  with_other.take(at(1.0), machine(1.0));
  EXPECT_EQ(with_other.referee().phase, GamePhase::kNoReferee);
}

TEST(ExternalInput, RobotsWaitForTheFirstMessageOfARequestedReferee) {
  Mailbox<RefereeState> mailbox;
  ExternalInputSettings settings{nullptr, &mailbox, {}};
  settings.awaits_referee = true;
  ExternalInput input(settings);
  input.take(at(1.0), machine(1.0));
  EXPECT_EQ(input.halt(at(1.0), 1s), kHaltSilence);
  RefereeState state;
  state.phase = GamePhase::kRunning;
  state.received = machine(2.0);
  mailbox.put(state);
  input.take(at(2.0), machine(2.0));
  EXPECT_EQ(input.halt(at(100.0), 1s), kHaltNone) << "this referee sends changes only";
}

TEST(ExternalInput, WhatTheRefereeDoesNotSayRemains) {
  Mailbox<RefereeState> mailbox;
  ExternalInput input({nullptr, &mailbox, {}});
  RefereeState state;
  state.own_is_yellow = true;
  state.own_on_positive_half = false;
  mailbox.put(state);
  input.take(at(0.0), machine(0.0));
  state.own_is_yellow.reset();
  state.own_on_positive_half = true;
  mailbox.put(state);
  input.take(at(0.0), machine(0.0));
  EXPECT_EQ(input.referee().own_is_yellow, true);
  EXPECT_EQ(input.referee().own_on_positive_half, true);
}

class ExternalInputLoop : public LoopTest {
 protected:
  ExternalInputLoop() {
    settings.external = {&commands, &referee, false};
    camera.show_robot();
  }
  void begin() {
    start({[](void* context, const StepTrace& trace, const StepTiming&) {
             static_cast<std::vector<Commands>*>(context)->push_back(trace.commands);
           },
           &seen});
  }
  void put_command(Instant received) {
    ExternalCommands table;
    table.push_back(turn_robot(0, received));
    commands.put(table);
  }
  void put_referee(const RefereeState& state) {
    RefereeState stamped = state;
    stamped.received = when_taken();
    referee.put(stamped);
  }
  // Returns the command of the only robot in the frame at this time.
  [[nodiscard]] const RobotCommand& at_frame(double time_s) const {
    return seen[static_cast<std::size_t>(std::lround(time_s / 0.02)) - 1].robots[0];
  }

  Mailbox<ExternalCommands> commands;
  Mailbox<RefereeState> referee;
  std::vector<Commands> seen;
};

TEST_F(ExternalInputLoop, DrivesTheRobotUntilTheCommandIsTooOld) {
  begin();
  run_until(1.0);
  EXPECT_EQ(at_frame(1.0).source, CommandSource::kPlay);
  put_command(when_taken());
  run_until(2.0);
  // The command is taken at the end of the frame of 1.00 s; the age limit is 0.2 s.
  for (double t = 1.02; t < 1.205; t += 0.02) {
    EXPECT_EQ(at_frame(t).source, CommandSource::kExternal) << t;
    // It is within the limits of acceleration, whatever the play commanded before.
    // While it brakes, rounding turns it by less than 0.0001 rad/s.
    EXPECT_GE(at_frame(t).twist.w_radps, std::min(2.99f, at_frame(t - 0.02).twist.w_radps) - 1e-4f) << t;
  }
  // The play drove the robot at full speed. Both wheels brake by 4 m/s^2, 0.08 m/s a frame, before it turns.
  const auto speed_at = [&](double t) { return std::abs(at_frame(t).twist.v_mps); };
  EXPECT_LE(speed_at(1.2), std::max(0.0f, speed_at(1.02) - 9 * 0.08f) + 0.01f);
  for (double t = 1.22; t < 1.99; t += 0.02) {
    EXPECT_EQ(at_frame(t).source, CommandSource::kExpired) << t;
    EXPECT_EQ(at_frame(t).twist.w_radps, 0.0f);
  }
  EXPECT_EQ(loop->statistics().external.commands, 1U);
  EXPECT_EQ(loop->statistics().external.commands_expired, 1U);
  const std::string text = summary(loop->statistics(), LoopEnd::kRequested);
  EXPECT_NE(text.find("commands  1 of other programs; 1 times a robot stopped"), std::string::npos) << text;
}

TEST_F(ExternalInputLoop, ACommandThatArrivesTooOldDrivesNothing) {
  begin();
  run_until(1.0);
  put_command(hal::MonotonicClock::read() - 250ms);
  run_until(1.1);
  EXPECT_EQ(at_frame(1.02).source, CommandSource::kExpired);
  EXPECT_EQ(at_frame(1.02).twist.w_radps, 0.0f);
}

TEST_F(ExternalInputLoop, AHaltOfTheRefereeDoesNotWaitForTheNextFrame) {
  begin();
  run_until(1.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  const std::size_t sent = radio.sent.size();
  RefereeState state;
  state.phase = GamePhase::kStop;
  put_referee(state);
  static_cast<void>(loop->iterate());
  ASSERT_GT(radio.sent.size(), sent);
  EXPECT_TRUE(radio.sent[sent].stop);
  EXPECT_NEAR(radio.sent[sent].at_s, 1.0, 1e-6);
  run_until(2.0);
  EXPECT_TRUE(all_stop(1.001, 2.0));
  state.phase = GamePhase::kRunning;
  put_referee(state);
  run_until(5.0);
  EXPECT_FALSE(all_stop(2.001, 5.0)) << "this referee sends changes only";
  std::string lines;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kHalt) lines += halt_line(report.halt) + "\n";
  }
  EXPECT_NE(lines.find("robots halted: the referee stopped the game\n"), std::string::npos) << lines;
  EXPECT_EQ(loop->statistics().external.referee_messages, 2U);
}

TEST_F(ExternalInputLoop, ASilentRefereeThatShouldRepeatItsMessagesStopsTheRobots) {
  settings.faults.referee_timeout_s = 0.5;
  begin();
  RefereeState state;
  state.phase = GamePhase::kRunning;
  state.repeats = true;
  for (int i = 1; i <= 10; ++i) {
    put_referee(state);
    run_until(0.1 * i);
  }
  run_until(2.0);
  EXPECT_FALSE(all_stop(0.0, 1.4));
  EXPECT_TRUE(all_stop(1.45, 2.0));
  put_referee(state);
  run_until(2.3);
  EXPECT_FALSE(all_stop(2.03, 2.3));
}

TEST_F(ExternalInputLoop, TheStartButtonLetsAnotherRefereeBeFollowed) {
  std::atomic<std::uint32_t> releases{0};
  settings.external.referee_releases = &releases;
  settings.start_button = true;
  gpio.press(1.0);
  gpio.press(2.0);
  begin();
  run_until(0.9);
  EXPECT_EQ(releases, 0U);
  run_until(3.0);
  EXPECT_EQ(releases, 2U);
}

TEST_F(ExternalInputLoop, TeamColorsThatCannotBeExchangedStopTheRobots) {
  begin();  // the opponents have no color
  run_until(1.0);
  RefereeState state;
  state.phase = GamePhase::kRunning;
  state.own_is_yellow = true;
  put_referee(state);
  run_until(2.0);
  EXPECT_TRUE(all_stop(1.001, 2.0));
  state.own_is_yellow = false;
  put_referee(state);
  run_until(3.0);
  EXPECT_FALSE(all_stop(2.03, 3.0));
  state.own_height_m = 3.0f;
  put_referee(state);
  run_until(4.0);
  EXPECT_TRUE(all_stop(3.03, 4.0));
  EXPECT_EQ(halt_line({1.0, kHaltTeams, kHaltNone}),
            "1.0 s  robots halted: the referee's team colors or heights do not fit the team file");
}

TEST_F(ExternalInputLoop, WithoutKnownTeamColorsThoseOfTheRefereeAreIgnored) {
  settings.external.own_is_yellow.reset();
  begin();
  RefereeState state;
  state.own_is_yellow = true;
  put_referee(state);
  run_until(1.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
}

// Both mailboxes while a loop runs; also run under the thread sanitizer.
TEST(ThreadsExternalInput, LoopFollowsWhatAnotherThreadReceives) {
  hal::MonotonicClock clock;
  FakeCamera camera(clock);
  camera.show_robot();
  FakeRadio radio(clock);
  FakeGpio gpio(clock);
  const auto pipeline = std::make_unique<Pipeline>();
  ASSERT_TRUE(pipeline->configure(fake_camera_parameters()).ok());
  const auto ring = std::make_unique<ReportRing>();
  Mailbox<ExternalCommands> commands;
  Mailbox<RefereeState> referee;
  LoopSettings settings;
  settings.duration = 400ms;
  settings.external = {&commands, &referee, {}};
  int driven = 0;
  Loop loop({camera, radio, gpio, clock}, *pipeline, settings, *ring,
            {[](void* context, const StepTrace& trace, const StepTiming&) {
               for (const RobotCommand& robot : trace.commands.robots) {
                 *static_cast<int*>(context) += robot.source == CommandSource::kExternal ? 1 : 0;
               }
             },
             &driven});
  ASSERT_TRUE(loop.open().ok());
  std::atomic<bool> end{false};
  std::thread receiver([&] {
    while (!end) {
      const Instant now = hal::MonotonicClock::read();
      ExternalCommands table;
      table.push_back(turn_robot(0, now));
      commands.put(table);
      RefereeState state;
      state.phase = GamePhase::kRunning;
      state.repeats = true;
      state.received = now;
      referee.put(state);
      std::this_thread::sleep_for(1ms);
    }
  });
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop.run(stop), LoopEnd::kLimit);
  end = true;
  receiver.join();
  EXPECT_GT(driven, 2);
  EXPECT_GT(loop.statistics().external.commands, 2U);
  EXPECT_GT(loop.statistics().external.referee_messages, 2U);
  loop.close();
}

}  // namespace
}  // namespace touchline::testing
