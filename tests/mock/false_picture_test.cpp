// Pictures that do not show the scene before the camera must stop the robots; nothing else may.
#include <gtest/gtest.h>

#include <limits>
#include <ostream>
#include <span>
#include <utility>

#include "firmware/loop.h"
#include "tests/mock/mock_game.h"
#include "tests/radio/touchline_packets.h"
#include "tests/results.h"

namespace touchline {
namespace {

using hal::mock::FaultKind;

/// A radio whose robots have exchanged motors: all turn to the wrong side.
class ExchangedMotors final : public hal::Radio {
 public:
  ExchangedMotors(hal::Radio& radio, const hal::Clock& clock) : radio_(radio), clock_(clock) {}
  double from_s = std::numeric_limits<double>::infinity();

 private:
  Result<void> do_open() override { return radio_.open(); }
  void do_close() override { radio_.close(); }
  Result<void> do_send(const Packet& packet, std::size_t receiver) override {
    Commands commands;
    std::uint8_t sequence = 0;
    if (seconds(clock_.now() - hal::mock::Arena::kBegin) < from_s ||
        !decode({packet.data(), packet.size()}, commands, sequence).ok()) {
      return radio_.send(packet, receiver);
    }
    for (RobotCommand& robot : commands.robots) std::swap(robot.wheels.left_mps, robot.wheels.right_mps);
    Packet changed;
    static_cast<void>(encode(commands, sequence, changed));
    return radio_.send(changed, receiver);
  }
  Result<Duration> do_serve() override { return radio_.serve(); }
  Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) override {
    return radio_.receive(into, sender);
  }
  Result<void> do_drain(Instant deadline) override { return radio_.drain(deadline); }

  hal::Radio& radio_;
  const hal::Clock& clock_;
};

/// A game of the board's arena that counts the packets that drive robots.
class WatchedGame : public MockGame {
 public:
  explicit WatchedGame(std::uint64_t seed, std::vector<hal::mock::ArenaFault> faults = {},
                       std::vector<std::string> overrides = {})
      : MockGame(seed, std::move(faults), std::move(overrides)) {
    exchanged_motors.emplace(*radio, *clock);
    open(loop, *camera, *exchanged_motors, *gpio, settings(), LoopObserver{&WatchedGame::observe, this});
  }

  void run_until(double end_s) {
    while (now_s() < end_s) {
      ASSERT_FALSE(loop->iterate().has_value());
      halts |= loop->halt();
    }
  }

  std::optional<ExchangedMotors> exchanged_motors;
  std::optional<Loop> loop;
  int frames = 0, driving = 0;
  double last_driving_s = 0.0;
  std::uint32_t halts = 0;  // all reasons since the last clear()

  void clear() {
    frames = driving = 0;
    halts = 0;
  }

 private:
  static void observe(void* context, const StepTrace& trace, const StepTiming&) {
    WatchedGame& game = *static_cast<WatchedGame*>(context);
    ++game.frames;
    if (!trace.commands.stop) {
      ++game.driving;
      game.last_driving_s = game.now_s();
    }
  }
};

// The fault lasts from second 2.5 on. Without these rules, all packets drive robots.
struct Attack {
  const char* name;
  FaultKind kind;
  std::uint32_t halts;
  int most_driving;  // number of packets, of 60 a second
};
void PrintTo(const Attack& attack, std::ostream* out) { *out << attack.name; }
class FalsePicture : public ::testing::TestWithParam<Attack> {};

TEST_P(FalsePicture, StopsTheRobots) {
  WatchedGame game(1, {{GetParam().kind, 2.5, 10.0}});
  game.run_until(2.5);
  EXPECT_EQ(game.driving, game.frames);
  EXPECT_EQ(game.halts & kPictureHalts, 0);
  game.clear();
  game.run_until(4.5);
  EXPECT_EQ(game.halts & ~kHaltNoFrames, GetParam().halts);
  EXPECT_LE(game.driving, GetParam().most_driving);
  EXPECT_LT(game.last_driving_s, 2.5 + (GetParam().most_driving + 2) / 60.0) << "they stay stopped";
}

INSTANTIATE_TEST_SUITE_P(, FalsePicture,
                         ::testing::Values(Attack{"Frozen", FaultKind::kPictureFrozen, kHaltRepeats, 14},
                                           Attack{"HalfFrozen", FaultKind::kPictureHalfFrozen, kHaltRepeats, 14},
                                           Attack{"Torn", FaultKind::kPictureTorn, kHaltRepeats, 2},
                                           Attack{"Turned", FaultKind::kPictureTurned, kHaltMotion, 2},
                                           Attack{"Random", FaultKind::kPictureRandom, kHaltOverload | kHaltField, 5},
                                           Attack{"Dark", FaultKind::kDark, kHaltField, 5}),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

// Some reasons for stopped robots can be checked while robots stand: such a stop ends as soon as the reason has ended,
// and tracks begin anew.
TEST(FalsePictureEnds, RobotsGoOnWithANewPicture) {
  for (const FaultKind kind : {FaultKind::kPictureFrozen, FaultKind::kPictureRandom, FaultKind::kDark}) {
    WatchedGame game(1, {{kind, 2.0, 1.0}});
    game.run_until(3.0);
    EXPECT_NE(game.halts & kPictureHalts, 0);
    game.run_until(3.2);
    game.clear();
    game.run_until(4.0);
    EXPECT_EQ(game.driving, game.frames);
    EXPECT_EQ(game.halts, kHaltNone);
  }
}

// A reason that cannot be checked while robots stand holds until a person starts them, whatever the picture shows in
// the meantime.
TEST(FalsePictureEnds, ATurnedOrTornPictureNeedsAStart) {
  for (const FaultKind kind : {FaultKind::kPictureTurned, FaultKind::kPictureTorn}) {
    WatchedGame game(1, {{kind, 2.0, 0.8}, {FaultKind::kStartButton, 4.0, 0.2}});
    game.run_until(2.1);
    game.clear();
    game.run_until(4.0);
    EXPECT_EQ(game.driving, 0);
    game.run_until(4.1);
    game.clear();
    game.run_until(5.0);
    EXPECT_EQ(game.driving, game.frames);
  }
}

TEST(NoFalsePicture, RobotsThatAreSwitchedOffAreAWarning) {
  WatchedGame game(1, {}, {"arena.radio.loss=1.0"});
  game.run_until(4.0);
  EXPECT_EQ(game.halts & kPictureHalts, 0);
  EXPECT_EQ(game.driving, game.frames);
  int warnings = 0;
  for (Report report; game.ring->pop(report);) {
    if (report.kind != Report::Kind::kStanding) continue;
    ++warnings;
    EXPECT_LT(report.standing.elapsed_s, 3.0);
    EXPECT_GE(report.standing.robots, 1);
  }
  EXPECT_EQ(warnings, 1);
}

TEST(NoFalsePicture, RobotsThatAreLiftedAndPutDownElsewhere) {
  WatchedGame game(1);
  game.run_until(2.0);
  game.arena->world().place(0, {0.0, 50.0, 0.0});
  game.run_until(2.2);
  for (std::size_t i = 1; i < 5; ++i) game.arena->world().place(i, {static_cast<double>(i), 50.0, 0.0});
  game.run_until(3.5);
  for (std::size_t i = 0; i < 5; ++i) game.arena->world().place(i, {-0.9 + 0.15 * static_cast<double>(i), -0.7, 2.0});
  game.run_until(5.0);
  EXPECT_EQ(game.halts & kPictureHalts, 0);
}

TEST(NoFalsePicture, LampsThatAreSwitched) {
  WatchedGame game(1);
  int exposure_us = 0;
  for (const double factor : {1.0, 0.5, 1.6, 0.8}) {
    hal::CameraSettings camera = game.arena->camera();
    if (exposure_us == 0) exposure_us = camera.exposure_us > 0 ? camera.exposure_us : 5000;
    camera.exposure_us = static_cast<int>(factor * exposure_us);
    game.arena->adjust_camera(camera);
    game.run_until(game.now_s() + 1.0);
  }
  EXPECT_EQ(game.halts & kPictureHalts, 0);
  EXPECT_EQ(game.driving, game.frames);
}

TEST(NoFalsePicture, PicturesWithoutNoise) {
  WatchedGame game(1, {{FaultKind::kPictureFrozen, 4.0, 2.0}},
                   {"arena.sensor.read_noise_electrons=0.0", "arena.sensor.full_well_electrons=1e7"});
  game.run_until(4.0);
  EXPECT_EQ(game.halts & kPictureHalts, 0);
  EXPECT_EQ(game.driving, game.frames);
  game.clear();
  game.run_until(5.0);
  EXPECT_NE(game.halts & kHaltRepeats, 0) << "robots are commanded, and nothing at all moves";
  EXPECT_LT(game.last_driving_s, 4.5);
}

TEST(ContradictingMotion, ATeamThatTurnsToTheWrongSideStops) {
  WatchedGame game(1);
  game.exchanged_motors->from_s = 2.0;
  game.run_until(6.0);
  EXPECT_NE(game.loop->halt() & kHaltMotion, 0);
  EXPECT_LT(game.last_driving_s, 5.0);
}

}  // namespace
}  // namespace touchline
