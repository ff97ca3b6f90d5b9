// A side that plays without pictures.
#include "hal/mock/simulated_side.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <memory>
#include <vector>

#include "firmware/arena_sides.h"
#include "hal/mock/game.h"
#include "tests/results.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::hal::mock {
namespace {

using namespace std::chrono_literals;

class SimulatedSideTest : public ::testing::Test {
 protected:
  void load(std::vector<std::string> overrides = {}) {
    ASSERT_OK(config::load({TOUCHLINE_BOARDS "/mock/board.toml", "", "", std::move(overrides)}, *configuration_));
    for (const Side side : {Side::kOwn, Side::kOpponent}) {
      auto& player = sides_[static_cast<std::size_t>(side)];
      player = std::make_unique<SimulatedSide>(arena(), side, 1);
      ASSERT_TRUE(player->configure(side_settings(*configuration_, side)).ok());
      player->set_observer(
          [](void* test, const StepTrace& trace) { static_cast<SimulatedSideTest*>(test)->on_step(trace); }, this);
    }
    resets_.reserve(100);  // a test counts allocations
    game_ = std::make_unique<Game>(arena(), configuration_->board.radio, 1);
    for (const Side side : {Side::kOwn, Side::kOpponent}) {
      game_->set_side(side, sides_[static_cast<std::size_t>(side)].get());
    }
  }
  [[nodiscard]] const ArenaParameters& arena() const { return configuration_->board.arena; }
  void run(double seconds) { game_->advance_to(game_->now() + from_seconds(seconds)); }
  void on_step(const StepTrace& trace) {
    ++steps_;
    stop_packets_ += trace.commands.stop ? 1 : 0;
    tracks_ = trace.tracks;
    if (trace.inputs->events.reset) resets_.push_back(trace.frame.capture_time - game_->last_jump());
  }

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::array<std::unique_ptr<SimulatedSide>, 2> sides_;
  std::unique_ptr<Game> game_;
  int steps_ = 0, stop_packets_ = 0;
  Tracks tracks_;                 // of the last step of any side
  std::vector<Duration> resets_;  // for each step that reset the tracks: from the jump to the capture of its frame
};

TEST_F(SimulatedSideTest, BothSidesPlayAtTheCamerasRateOverTheirOwnRadio) {
  load();
  run(10.0);
  for (const auto& side : sides_) EXPECT_NEAR(static_cast<double>(side->frames()), 600.0, 3.0);
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    EXPECT_NEAR(static_cast<double>(game_->channel(side).statistics().sent), 600.0, 3.0);
    EXPECT_GT(game_->channel(side).statistics().obeyed, 2500U);
    EXPECT_GT(game_->channel(side).statistics().lost, 20U);
    EXPECT_GT(game_->statistics().touches[static_cast<std::size_t>(side)], 0U);
  }
}

TEST_F(SimulatedSideTest, ASidesHaltStopsItsRobotsAlone) {
  load();
  sides_[0]->inputs().halt = 4;
  const Snapshot before = game_->world().snapshot();
  run(2.0);
  const Snapshot after = game_->world().snapshot();
  double others = 0.0;
  for (std::size_t i = 0; i < after.robots.size(); ++i) {
    const double way =
        std::hypot(after.robots[i].x_m - before.robots[i].x_m, after.robots[i].y_m - before.robots[i].y_m);
    if (game_->world().side(i) == Side::kOpponent) others += way;
  }
  EXPECT_GT(others, 0.3);
  EXPECT_NEAR(stop_packets_, steps_ / 2, 2);
}

TEST_F(SimulatedSideTest, ARestartHoldsBothSidesForASecondAndForgetsTracks) {
  load({"arena.robots_return=true"});
  run(3.0);
  game_->rules().place_ball({1.12, 0.0, 0.0}, {3.0, 0.0});  // behind every robot
  stop_packets_ = 0;
  run(0.5);
  ASSERT_EQ(game_->statistics().goals_own, 1U);
  EXPECT_TRUE(game_->rules().is_stopped());
  EXPECT_GT(stop_packets_, 30);
  for (std::size_t i = 0; i < arena().robot.size(); ++i) {
    EXPECT_NEAR(game_->world().snapshot().robots[i].x_m, arena().robot[i].x_m, 1e-9);
  }
  run(1.0);
  EXPECT_FALSE(game_->rules().is_stopped());
  EXPECT_EQ(tracks_.robots.size(), 10U);
  // A robot that somebody puts elsewhere while the game is stopped stays there.
  game_->rules().place_ball({1.12, 0.0, 0.0}, {3.0, 0.0});  // behind every robot
  run(0.3);
  ASSERT_TRUE(game_->rules().is_stopped());
  game_->rules().place_robot(0, {-0.9, 0.7, 0.0});
  run(0.2);
  EXPECT_NEAR(game_->world().snapshot().robots[0].y_m, 0.7, 1e-9);
}

// A frame that was on its way when everything was put elsewhere still shows the former places.
TEST_F(SimulatedSideTest, TracksBeginWithTheFirstFrameAfterAJump) {
  load();
  run(3.0);
  for (std::size_t i = 0; i < arena().robot.size(); ++i) {
    const Placement& at = game_->world().snapshot().robots[i];
    game_->rules().place_robot(i, {-at.x_m, -at.y_m, at.theta_rad});
  }
  game_->note_jump();
  resets_.clear();
  run(0.2);
  ASSERT_EQ(resets_.size(), 2U) << "one for each side";
  for (const Duration after : resets_) {
    EXPECT_GE(after, Duration::zero()) << "the frame was captured before the jump";
    EXPECT_LE(after, 20ms);
  }
}

TEST_F(SimulatedSideTest, BothSidesSeeTheReferee) {
  load({"arena.rules.league=mirosot"});
  run(0.5);
  const GameSituation own = sides_[0]->inputs().situation, other = sides_[1]->inputs().situation;
  EXPECT_EQ(own.phase, GamePhase::kPrepare);
  EXPECT_EQ(own.restart, Restart::kKickOff);
  EXPECT_NE(own.ours, other.ours);
  run(0.52);
  EXPECT_EQ(sides_[0]->inputs().situation.phase, GamePhase::kRunning);
  EXPECT_EQ(sides_[0]->inputs().situation.restart, Restart::kKickOff) << "nobody has touched the ball";
  run(10.0);
  EXPECT_EQ(sides_[0]->inputs().situation.restart, Restart::kNone);
}

TEST_F(SimulatedSideTest, RobotsDriveToTheirPlacesForAKickOff) {
  load({"arena.rules.league=mirosot", "arena.rules.robots=drive"});
  run(6.0);
  game_->rules().place_ball({1.05, 0.0, 0.0}, {3.0, 0.0});
  run(0.3);
  ASSERT_EQ(game_->statistics().goals_own, 1U);
  stop_packets_ = 0;
  double way = 0.0;
  Snapshot before = game_->world().snapshot();
  int steps = 0;
  while (sides_[0]->inputs().situation.phase == GamePhase::kPrepare && ++steps < 200) {
    run(0.05);
    const Snapshot now = game_->world().snapshot();
    for (std::size_t i = 0; i < now.robots.size(); ++i) {
      const double moved =
          std::hypot(now.robots[i].x_m - before.robots[i].x_m, now.robots[i].y_m - before.robots[i].y_m);
      way += moved;
      EXPECT_LT(moved, 0.1) << "nobody carried robot " << i;
    }
    before = now;
  }
  EXPECT_GT(way, 1.0);
  EXPECT_EQ(stop_packets_, 0);
  EXPECT_LT(steps, 200);
  EXPECT_NEAR(before.ball.x_m, 0.0, 0.02);
  for (std::size_t i = 0; i < before.robots.size(); ++i) {
    const double direction = game_->world().side(i) == Side::kOwn ? 1.0 : -1.0;
    EXPECT_LT(direction * before.robots[i].x_m, 0.0) << i << ": in its own half";
  }
}

TEST_F(SimulatedSideTest, AfterAHalfBothSidesAttackTheOtherGoal) {
  load({"arena.rules.half_s=4", "arena.rules.league=mirosot"});
  run(5.5);
  for (const auto& side : sides_) EXPECT_TRUE(side->inputs().teams.sides_exchanged);
  const double ball = game_->world().ball().x;
  // The own robots stand at the positive side of the ball and drive towards negative x.
  double own = 0.0;
  const Snapshot now = game_->world().snapshot();
  for (std::size_t i = 0; i < now.robots.size(); ++i)
    own += game_->world().side(i) == Side::kOwn ? now.robots[i].x_m : 0.0;
  EXPECT_GT(own / 5.0, ball);
}

TEST_F(SimulatedSideTest, LateFramesArriveInOrder) {
  load({"arena.view.late=0.3", "arena.view.late_s=0.05"});
  std::vector<Instant> captures;
  sides_[0]->set_observer(
      [](void* all, const StepTrace& trace) {
        static_cast<std::vector<Instant>*>(all)->push_back(trace.frame.capture_time);
      },
      &captures);
  run(5.0);
  EXPECT_NEAR(static_cast<double>(captures.size()), 300.0, 8.0);
  EXPECT_TRUE(std::is_sorted(captures.begin(), captures.end()));
  EXPECT_EQ(tracks_.robots.size(), 10U);
}

TEST_F(SimulatedSideTest, NothingIsAllocatedWhileTheyPlay) {
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "with a sanitizer, allocations are not counted";
  load({"arena.robots_return=true", "arena.view.miss=0.02", "arena.view.late=0.1", "arena.rules.league=mirosot",
        "arena.rules.robots=drive"});
  run(1.0);
  const std::uint64_t before = latency::allocations_of_this_thread();
  run(5.0);
  game_->rules().place_ball({1.12, 0.0, 0.0}, {3.0, 0.0});  // behind every robot
  run(3.0);
  EXPECT_EQ(latency::allocations_of_this_thread() - before, 0U);
  EXPECT_EQ(game_->statistics().goals_own, 1U);
}

}  // namespace
}  // namespace touchline::hal::mock
