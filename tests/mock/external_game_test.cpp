// Other programs and a referee in games of the board boards/mock.
#include <gtest/gtest.h>

#include <array>
#include <chrono>

#include "core/geometry/vector2.h"
#include "firmware/arena_objects.h"
#include "firmware/session.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/results.h"

namespace touchline {
namespace {

using namespace std::chrono_literals;

// A time of reception in the future counts as that at which the loop takes the value.
Instant when_taken() { return hal::MonotonicClock::read() + 1h; }

class ExternalGame : public ::testing::Test {
 protected:
  void begin(std::vector<std::string> overrides, bool has_referee = true) {
    SessionOptions options;
    options.files.board = TOUCHLINE_BOARDS "/mock/board.toml";
    options.files.overrides = std::move(overrides);
    ASSERT_OK(session_.load(options));
    session_.set_external_input({&commands_, has_referee ? &referee_ : nullptr, false});
    ASSERT_OK(session_.open({&ExternalGame::look, this}));
  }
  void run(int frames) {
    for (const int end = frames_ + frames; frames_ < end;) ASSERT_FALSE(session_.loop().iterate().has_value());
  }
  void put(const RefereeState& state) {
    RefereeState stamped = state;
    stamped.received = when_taken();
    referee_.put(stamped);
  }
  [[nodiscard]] std::size_t identified(Team team) const {
    return static_cast<std::size_t>(
        std::count_if(tracks_.robots.begin(), tracks_.robots.end(), [team](const RobotTrack& robot) {
          return robot.team == team && robot.id != kUnknownId && robot.state == TrackState::kSeen;
        }));
  }
  /// Largest distance of an own robot from its place at the start, for robots that have not moved.
  [[nodiscard]] double worst_error_m() const {
    double worst = 0.0;
    for (const RobotTrack& robot : tracks_.robots) {
      for (const auto& placed : session_.configuration().board.arena.robot) {
        if (robot.team != Team::kOwn || placed.team != hal::mock::Side::kOwn || placed.id != robot.id) continue;
        worst = std::max(worst, distance(position(robot.pose), {placed.x_m, placed.y_m}));
      }
    }
    return worst;
  }

  Session session_;
  Mailbox<ExternalCommands> commands_;
  Mailbox<RefereeState> referee_;
  Tracks tracks_;
  Commands sent_;
  StepInputs inputs_;
  std::array<double, 16> way_m_{};  // of the own robots, by id
  int frames_ = 0;

 private:
  static void look(void* context, const StepTrace& trace, const StepTiming&) {
    ExternalGame& game = *static_cast<ExternalGame*>(context);
    ++game.frames_;
    for (const RobotTrack& robot : trace.tracks.robots) {
      if (robot.team != Team::kOwn || robot.id < 0 || robot.id >= 16) continue;
      game.way_m_[static_cast<std::size_t>(robot.id)] += std::abs(static_cast<double>(robot.twist.v_mps)) / 60.0;
    }
    game.tracks_ = trace.tracks;
    game.sent_ = trace.commands;
    game.inputs_ = *trace.inputs;
  }
};

TEST_F(ExternalGame, WhenAStrategyEndsItsRobotStopsAndTheOthersPlayOn) {
  begin({"arena.opponents=stand"});  // playing opponents would push the stopped robot
  run(30);
  for (int i = 0; i < 60; ++i) {
    ExternalCommand command;
    command.id = 2;
    command.twist = {0.2f, 4.0f};  // in circles
    command.received = when_taken();
    ExternalCommands table;
    table.push_back(command);
    commands_.put(table);
    run(1);
  }
  EXPECT_GT(way_m_[2], 0.1);
  // The age limit is 12 frames. After another 12 frames, the robot has stopped.
  run(25);
  way_m_ = {};
  run(60);
  EXPECT_LT(way_m_[2], 0.01);
  run(120);
  for (const RobotCommand& robot : sent_.robots) {
    EXPECT_EQ(robot.source, robot.id == 2 ? CommandSource::kExpired : CommandSource::kPlay);
    if (robot.id == 2) {
      EXPECT_EQ(robot.twist.v_mps, 0.0f);
      EXPECT_EQ(robot.twist.w_radps, 0.0f);
    }
  }
  EXPECT_GT(way_m_[0] + way_m_[1] + way_m_[3] + way_m_[4], 0.5);
  EXPECT_EQ(session_.loop().statistics().external.commands_expired, 1U);
}

// All robots are elsewhere at once, which without the arena's word would be a reason to stop them (kHaltMotion).
TEST_F(ExternalGame, AResetOfTheArenaBeginsTracksAnewAndStopsNobody) {
  const auto objects = std::make_shared<ArenaObjects>();
  session_.set_arena_objects(objects);
  begin({"arena.opponents=stand"});
  run(150);
  EXPECT_GT(worst_error_m(), 0.2) << "robots have left their places";
  ArenaRequest reset;
  reset.kind = ArenaRequest::Kind::kReset;
  ASSERT_OK(objects->control(reset));
  run(4);
  EXPECT_LT(worst_error_m(), 0.03);
  run(60);
  EXPECT_FALSE(sent_.stop);
  EXPECT_GT(worst_error_m(), 0.05) << "they play on";
}

TEST_F(ExternalGame, TeamColorsAreExchangedDuringAGame) {
  // In the arena the own team is yellow, in the team file it is blue.
  begin({"arena.own_color=yellow", "arena.opponent_color=blue"});
  run(30);
  EXPECT_LT(identified(Team::kOwn), 5U);
  RefereeState state;
  state.phase = GamePhase::kRunning;
  state.own_is_yellow = true;
  put(state);
  run(30);
  EXPECT_EQ(identified(Team::kOwn), 5U);
  EXPECT_EQ(identified(Team::kOpponent), 5U);
  run(120);
  EXPECT_GT(way_m_[0] + way_m_[1] + way_m_[2] + way_m_[3] + way_m_[4], 0.5) << "they play";
  state.own_is_yellow = false;
  put(state);
  run(30);
  EXPECT_LT(identified(Team::kOwn), 5U);
}

TEST_F(ExternalGame, HeightsOfTheRefereeReplaceThoseOfTheTeamFile) {
  begin({"arena.robot_height_m=0.14", "arena.opponents=stand"});
  RefereeState state;
  state.phase = GamePhase::kHalt;
  put(state);
  run(30);
  EXPECT_GT(worst_error_m(), 0.01);
  state.own_height_m = 0.14f;
  put(state);
  run(30);
  EXPECT_EQ(identified(Team::kOwn), 5U) << "the tracks go on";
  EXPECT_LT(worst_error_m(), 0.003);
  state.own_height_m = 0.0f;
  put(state);
  run(30);
  EXPECT_GT(worst_error_m(), 0.01);
}

// The ball starts near the center, and nobody defends the other half. The ball is put back to the center after a goal.
TEST_F(ExternalGame, SidesAreExchanged) {
  begin({"arena.opponents=stand"});
  RefereeState state;
  state.phase = GamePhase::kRunning;
  state.own_on_positive_half = true;
  put(state);
  double first_end_m = 0.0;  // x of the ball when it is first more than 0.5 m from the center line
  int on_positive_half = 0, on_negative_half = 0, guarded = 0;
  for (int i = 0; i < 60 * 15; ++i) {
    run(1);
    const double x_m = static_cast<double>(tracks_.ball.position.x_m);
    if (first_end_m == 0.0 && std::abs(x_m) > 0.5) first_end_m = x_m;
    on_positive_half += x_m > 0.0 ? 1 : 0;
    on_negative_half += x_m < 0.0 ? 1 : 0;
    guarded += std::any_of(tracks_.robots.begin(), tracks_.robots.end(), [](const RobotTrack& robot) {
      return robot.team == Team::kOwn && position(robot.pose).x > 0.8;
    });
  }
  EXPECT_LT(first_end_m, -0.5);
  EXPECT_GT(on_negative_half, on_positive_half);
  EXPECT_GT(guarded, 60 * 5) << "frames with a goalkeeper before the goal at positive x, to which it has to drive";
}

TEST_F(ExternalGame, OpponentsPlayAlsoIfTheOwnRobotsWaitForAProgram) {
  begin({"control.play.enabled=false", "arena.opponents=follow"});
  run(1);
  const auto begin_m = tracks_.ball.position;
  run(60 * 8);
  const auto end_m = tracks_.ball.position;
  EXPECT_GT(std::hypot(end_m.x_m - begin_m.x_m, end_m.y_m - begin_m.y_m), 0.1F);
}

TEST_F(ExternalGame, TheArenasRefereeIsObeyedIfThereIsNoOtherOne) {
  begin({"arena.opponents=stand", "arena.rules.league=mirosot", "arena.rules.half_s=2"}, false);
  run(30);
  EXPECT_EQ(inputs_.situation.phase, GamePhase::kPrepare);
  EXPECT_EQ(inputs_.situation.restart, Restart::kKickOff);
  EXPECT_TRUE(sent_.stop) << "robots are held";
  EXPECT_EQ(session_.loop().statistics().external.referee_messages, 0U);
  run(50);
  EXPECT_EQ(inputs_.situation.phase, GamePhase::kRunning);
  EXPECT_FALSE(inputs_.teams.sides_exchanged);
  run(60);
  EXPECT_TRUE(inputs_.teams.sides_exchanged) << "the second half";
  EXPECT_EQ(inputs_.situation.phase, GamePhase::kPrepare);
}

}  // namespace
}  // namespace touchline
