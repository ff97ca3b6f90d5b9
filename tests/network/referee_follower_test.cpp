// Which senders may stop the game and which one releases it: replays, two referees, and restarts.
#include "firmware/network/referee_follower.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace touchline::network {
namespace {

using namespace std::chrono_literals;

constexpr GamePhase kRunning = GamePhase::kRunning, kHalt = GamePhase::kHalt, kStop = GamePhase::kStop;

struct Computer {
  std::uint32_t address = 0xc0a80105;  // 192.168.1.5
  std::uint16_t port = 4000;
  std::uint64_t source = 0;
};
constexpr Computer kA{}, kB{0xc0a80109, 5000, 0};

class Following : public ::testing::Test {
 protected:
  // A message of a referee that repeats its messages, sent at `stamp_s` of the sender's clock.
  void ssl(const Computer& by, GamePhase phase, std::uint32_t counter, double stamp_s) {
    RefereeMessage message;
    message.state.phase = phase;
    message.state.repeats = true;
    message.order = RefereeOrder{counter, static_cast<std::uint64_t>(stamp_s * 1e6), by.source};
    take(by, message);
  }
  // Stamped by a correct clock.
  void ssl(const Computer& by, GamePhase phase, std::uint32_t counter) { ssl(by, phase, counter, time_s()); }
  void vsss(const Computer& by, GamePhase phase) {
    RefereeMessage message;
    message.state.phase = phase;
    take(by, message);
  }
  void wait(double s) { now_ += from_seconds(s); }
  // The referee repeats a message 20 times a second in the meantime.
  void repeat(const Computer& by, GamePhase phase, std::uint32_t counter, double for_s) {
    for (double t = 0.0; t < for_s; t += 0.05) {
      wait(0.05);
      ssl(by, phase, counter);
    }
  }
  [[nodiscard]] double time_s() const { return 1.7e9 + seconds(now_ - Instant{}); }

  void take(const Computer& by, const RefereeMessage& message) {
    const hal::ReceivedMessage from{10, true, false, by.address, by.port};
    const auto state =
        follower_->follow(from, message, now_, [this](const std::string& line) { printed_.push_back(line); });
    if (state) state_ = *state;
  }

  std::optional<RefereeFollower> follower_{std::in_place, "ssl", 1s};
  Instant now_{100s};
  RefereeState state_;  // state as the loop has it
  std::vector<std::string> printed_;
};

TEST_F(Following, AHaltOfAnotherSenderStopsRobotsThatLineUp) {
  const auto lines_up = [&](const Computer& by, GamePhase phase, std::uint32_t counter) {
    RefereeMessage message;
    message.state.phase = phase;
    message.state.lines_up = true;
    message.state.restart = Restart::kKickOff;
    message.state.repeats = true;
    message.order = RefereeOrder{counter, static_cast<std::uint64_t>(time_s() * 1e6), 0};
    take(by, message);
    wait(0.05);
  };
  lines_up(kA, GamePhase::kPrepare, 5);
  EXPECT_EQ(permission_in(state_), Permission::kLineUp);
  lines_up(kB, kHalt, 9);
  lines_up(kA, GamePhase::kPrepare, 5);
  EXPECT_EQ(permission_in(state_), Permission::kStand);
  EXPECT_EQ(state_.restart, Restart::kNone);
  lines_up(kA, kRunning, 6);
  EXPECT_EQ(permission_in(state_), Permission::kPlay);
  // Another sender's stop lets them line up, but not play.
  lines_up(kB, kStop, 10);
  lines_up(kA, kRunning, 6);
  EXPECT_EQ(permission_in(state_), Permission::kLineUp);
}

TEST_F(Following, AReplayedStartReleasesNoHalt) {
  ssl(kA, kRunning, 5);
  const double recorded = time_s();
  repeat(kA, kRunning, 5, 1.0);
  ssl(kA, kHalt, 6);
  EXPECT_EQ(state_.phase, kHalt);
  const Instant halted = state_.received;
  // Messages from the same sender (forged, or delayed), from another port of its computer, and from another computer.
  for (const Computer& by : {kA, Computer{kA.address, 4001, 0}, kB}) {
    for (int i = 0; i < 8; ++i) {
      wait(0.01);
      ssl(by, kRunning, 5, recorded);
      EXPECT_EQ(state_.phase, kHalt);
    }
  }
  EXPECT_EQ(state_.received, halted) << "a replay is no sign of life";
  ssl(kA, kRunning, 7);
  EXPECT_EQ(state_.phase, kRunning);
}

TEST_F(Following, AReplayThatGoesOnAfterTheRefereeHasGoneReleasesNoHalt) {
  ssl(kA, kRunning, 5);
  const double recorded = time_s();
  repeat(kA, kHalt, 6, 1.0);
  for (int i = 0; i < 200; ++i) {
    wait(0.05);
    ssl(kB, kRunning, 5, recorded);
    EXPECT_EQ(state_.phase, kHalt);
  }
}

TEST_F(Following, AlternatingRefereesStopTheGameUntilTheFollowedOneGivesANewCommand) {
  ssl(kA, kRunning, 5);
  ssl(kB, kRunning, 90);
  EXPECT_EQ(state_.phase, kRunning);
  ssl(kB, kHalt, 91);
  EXPECT_EQ(state_.phase, kHalt) << "every permitted sender stops";
  for (int i = 0; i < 50; ++i) {
    wait(0.02);
    ssl(kA, kRunning, 5);
    EXPECT_EQ(state_.phase, kHalt) << "the followed one repeats what it said before";
    ssl(kB, kRunning, 92);
    EXPECT_EQ(state_.phase, kHalt) << "the other one cannot release it";
  }
  ssl(kA, kRunning, 6);
  EXPECT_EQ(state_.phase, kRunning);
  const std::vector<std::string> expected{
      "network: ssl: following the referee at 192.168.1.5:4000",
      "network: ssl: a start of 192.168.1.9:5000 is ignored, because 192.168.1.5:4000 is followed until it is silent "
      "for 1.0 s",
      "network: ssl: 192.168.1.9:5000 has stopped the game: robots stand until 192.168.1.5:4000, which is followed, "
      "gives a new command"};
  EXPECT_EQ(printed_, expected);
}

TEST_F(Following, AnotherRefereeIsFollowedAfterSilence) {
  ssl(kA, kRunning, 500);
  repeat(kB, kRunning, 3, 0.9);
  EXPECT_EQ(state_.received, Instant{100s}) << "the followed one is silent meanwhile, which the loop sees";
  repeat(kB, kRunning, 3, 0.3);
  EXPECT_EQ(state_.received, now_) << "counters start anew";
  EXPECT_EQ(state_.phase, kRunning);
  ssl(kA, kRunning, 501);
  ssl(kB, kHalt, 4);
  EXPECT_EQ(state_.phase, kHalt);
}

TEST_F(Following, ARestartedControllerStopsAtOnceAndReleasesAfterSilence) {
  // With another port, with another identifier, and with the same port.
  for (const Computer& restarted : {Computer{kA.address, 4001, 8}, Computer{kA.address, kA.port, 8}, kA}) {
    follower_.emplace("ssl", 1s);
    const Computer former = restarted.source == 0 ? kA : Computer{kA.address, kA.port, 7};
    repeat(former, kRunning, 500, 0.5);
    EXPECT_EQ(state_.phase, kRunning);
    wait(0.3);
    ssl(restarted, kHalt, 0);
    EXPECT_EQ(state_.phase, kHalt);
    repeat(restarted, kHalt, 0, 0.2);
    repeat(restarted, kRunning, 1, 0.2);
    EXPECT_EQ(state_.phase, kHalt) << "the former one may still be there";
    repeat(restarted, kRunning, 1, 0.6);
    EXPECT_EQ(state_.phase, kRunning);
    wait(0.02);
    ssl(restarted, kStop, 2);
    EXPECT_EQ(state_.phase, kStop);
  }
}

TEST_F(Following, ACommandOfTheSameRefereeGoesOnAfterALossOfTheNetwork) {
  repeat(kA, kRunning, 5, 0.5);
  wait(3.0);
  ssl(kA, kRunning, 5);
  EXPECT_EQ(state_.phase, kRunning);
  EXPECT_EQ(state_.received, now_);
}

TEST_F(Following, ARefereeWhoseClockIsBehindNeedsANewCommand) {
  ssl(kA, kHalt, 5);
  wait(2.0);
  double stamp_s = time_s() - 3600.0;
  ssl(kB, kRunning, 9, stamp_s);
  EXPECT_EQ(state_.phase, kHalt) << "as a recording would be";
  ssl(kB, kRunning, 10, stamp_s += 0.1);
  EXPECT_EQ(state_.phase, kRunning);
}

TEST_F(Following, AControllerInTwoNetworksIsOneReferee) {
  const Computer wired{kA.address, 4000, 7}, wireless{0xc0a80205, 4000, 7};
  double command_s = 0.0;
  for (std::uint32_t counter = 1; counter < 20; ++counter) {
    const GamePhase phase = counter % 2 == 0 ? kHalt : kRunning;
    const double former_s = command_s;
    wait(0.1);
    ssl(wired, phase, counter, command_s = time_s());
    EXPECT_EQ(state_.phase, phase);
    // The copy of the former message arrives late, and that of this one at once.
    if (counter > 1) ssl(wireless, counter % 2 == 0 ? kRunning : kHalt, counter - 1, former_s);
    ssl(wireless, phase, counter, command_s);
    EXPECT_EQ(state_.phase, phase) << counter;
  }
}

TEST_F(Following, AStopThatOvertakesTheRefereesOwnCopyCounts) {
  const Computer wired{kA.address, 4000, 7}, wireless{0xc0a80205, 4000, 7};
  ssl(wired, kRunning, 5);
  wait(0.1);
  ssl(wireless, kHalt, 6);
  EXPECT_EQ(state_.phase, kHalt);
  ssl(wired, kHalt, 6);
  wait(0.1);
  ssl(wired, kRunning, 7);
  EXPECT_EQ(state_.phase, kRunning);
}

TEST_F(Following, ACounterThatWrapsGoesOn) {
  ssl(kA, kHalt, 0xffffffff);
  wait(0.1);
  ssl(kA, kRunning, 0);
  EXPECT_EQ(state_.phase, kRunning);
}

TEST_F(Following, OnChangeOnlyTheFirstSenderIsFollowedUntilAPersonActs) {
  vsss(kA, kRunning);
  vsss(kB, kHalt);
  EXPECT_EQ(state_.phase, kHalt);
  vsss(kB, kRunning);
  wait(3600.0);
  vsss(kB, kRunning);
  EXPECT_EQ(state_.phase, kHalt);
  vsss(kA, kRunning);
  EXPECT_EQ(state_.phase, kRunning) << "a command is new whenever it comes";
  vsss(kA, kStop);
  follower_->release();
  EXPECT_EQ(state_.phase, kStop) << "nobody has started";
  vsss(kB, kRunning);
  EXPECT_EQ(state_.phase, kRunning);
  vsss(kA, kStop);
  EXPECT_EQ(state_.phase, kStop);
  vsss(kA, kRunning);
  EXPECT_EQ(state_.phase, kStop);
  const std::vector<std::string> expected{
      "network: ssl: following the referee at 192.168.1.5:4000",
      "network: ssl: 192.168.1.9:5000 has stopped the game: robots stand until 192.168.1.5:4000, which is followed, "
      "gives a new command",
      "network: ssl: a start of 192.168.1.9:5000 is ignored, because 192.168.1.5:4000 is followed until Start is "
      "pressed in the console, or Touchline is restarted",
      "network: ssl: following the referee at 192.168.1.9:5000",
      "network: ssl: 192.168.1.5:4000 has stopped the game: robots stand until 192.168.1.9:5000, which is followed, "
      "gives a new command",
      "network: ssl: a start of 192.168.1.5:4000 is ignored, because 192.168.1.9:5000 is followed until Start is "
      "pressed in the console, or Touchline is restarted"};
  EXPECT_EQ(printed_, expected);
}

TEST_F(Following, APersonsActDoesNotMoveARefereeThatRepeatsItsMessages) {
  ssl(kA, kHalt, 5);
  follower_->release();
  ssl(kB, kRunning, 6);
  EXPECT_EQ(state_.phase, kHalt);
}

}  // namespace
}  // namespace touchline::network
