// Restarts, fouls and halves by the rules of MiroSot and VSSS.
#include "hal/mock/league_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "hal/mock/game.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

constexpr double kHoldS = 1.0;

// Three robots of each side: the goalkeepers, and two in each half.
ArenaParameters league_arena() {
  ArenaParameters parameters = noise_free_arena();
  parameters.rules.league = League::kMirosot;
  parameters.physics.free_ball_after_s = 2.0;
  parameters.robot = {{Side::kOwn, 0, -1.0, 0.0, 0.0, {"red"}},       {Side::kOwn, 1, -0.4, 0.3, 0.0, {"red"}},
                      {Side::kOwn, 2, -0.4, -0.3, 0.0, {"red"}},      {Side::kOpponent, 0, 1.0, 0.0, 3.14, {"red"}},
                      {Side::kOpponent, 1, 0.4, -0.3, 3.14, {"red"}}, {Side::kOpponent, 2, 0.4, 0.3, 3.14, {"red"}}};
  return parameters;
}

class LeagueGame : public ::testing::Test {
 protected:
  void begin(const ArenaParameters& parameters) {
    game_.emplace(parameters, RadioSettings{}, 1);
    run(*game_, kHoldS + 0.01);
    // Somebody plays.
    game_->world().drive(0, -0.05, 0.05);
  }
  [[nodiscard]] Vector2 robot(std::size_t i) const { return position(game_->world().snapshot().robots[i]); }
  [[nodiscard]] Vector2 ball() const { return game_->world().ball(); }
  [[nodiscard]] const GameStatistics& statistics() const { return game_->statistics(); }
  [[nodiscard]] std::uint32_t restarts(Restart restart) const {
    return statistics().restarts[static_cast<std::size_t>(restart)];
  }
  [[nodiscard]] GameSituation seen_by(Side side) const { return std::as_const(*game_).rules().situation(side); }
  void put(std::size_t robot, double x, double y) { game_->world().place(robot, {x, y, 0.0}); }
  void put_ball(double x, double y) { game_->rules().place_ball({x, y, 0.0}); }
  void wait(double time_s) { run(*game_, time_s); }
  void keep_playing() { game_->world().drive(1, -0.05, 0.05); }

  std::optional<Game> game_;
};

TEST_F(LeagueGame, TheSideThatConcededKicksOff) {
  begin(league_arena());
  put_ball(1.0, 0.0);
  put(3, 1.0, 0.6);
  game_->rules().place_ball({1.0, 0.0, 0.0}, {1.5, 0.0});
  wait(0.3);
  ASSERT_EQ(statistics().goals_own, 1U);
  EXPECT_EQ(seen_by(Side::kOpponent), (GameSituation{GamePhase::kPrepare, Restart::kKickOff, true, false}));
  EXPECT_EQ(seen_by(Side::kOwn), (GameSituation{GamePhase::kPrepare, Restart::kKickOff, false, false}));
  EXPECT_EQ(ball().x, 0.0);
  EXPECT_NEAR(std::min(robot(4).x, robot(5).x), 0.0837, 0.01) << "the taker stands beside the ball";
  for (const std::size_t own : {0U, 1U, 2U}) {
    EXPECT_LT(robot(own).x, -0.05);
    EXPECT_GE(norm(robot(own)), 0.25);
  }
  EXPECT_EQ(statistics().fouls, (std::array<std::uint32_t, 2>{}));
  wait(kHoldS);
  EXPECT_EQ(seen_by(Side::kOpponent), (GameSituation{GamePhase::kRunning, Restart::kKickOff, true, false}));
  // The restart is over when a robot touches the ball.
  put(1, -0.058, 0.0);
  wait(0.01);
  EXPECT_EQ(seen_by(Side::kOpponent), (GameSituation{GamePhase::kRunning, Restart::kNone, false, false}));
}

TEST_F(LeagueGame, ABallThatStandsIsFreeAtTheMarkOfItsQuadrant) {
  begin(league_arena());
  put_ball(0.3, -0.7);
  wait(1.98);
  EXPECT_EQ(restarts(Restart::kFreeBall), 0U);
  wait(0.03);
  ASSERT_EQ(restarts(Restart::kFreeBall), 1U);
  EXPECT_NEAR(ball().x, 0.55, 1e-9);
  EXPECT_NEAR(ball().y, -0.5538, 1e-3);
  EXPECT_EQ(statistics().free_balls, 1U);
  EXPECT_FALSE(seen_by(Side::kOwn).ours || seen_by(Side::kOpponent).ours);
  int at_ball = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (distance(robot(i), ball()) < 0.21) {
      ++at_ball;
      EXPECT_NEAR(robot(i).x, ball().x + (i < 3 ? -0.2 : 0.2), 1e-9) << "on its own side";
    } else {
      EXPECT_TRUE(robot(i).x <= 0.0 || robot(i).y >= 0.0 || i == 3) << i << ": outside of the quadrant";
    }
  }
  EXPECT_EQ(at_ball, 2);
}

TEST_F(LeagueGame, TwoDefendersInTheirGoalAreaGiveAPenaltyKick) {
  begin(league_arena());
  put_ball(-1.02, 0.2);
  put(1, -1.0, -0.2);
  wait(0.45);
  EXPECT_EQ(restarts(Restart::kPenalty), 0U) << "a robot that passes is no foul";
  wait(0.1);
  ASSERT_EQ(restarts(Restart::kPenalty), 1U);
  EXPECT_EQ(statistics().fouls, (std::array<std::uint32_t, 2>{1, 0}));
  EXPECT_NEAR(ball().x, -0.55, 1e-9);
  EXPECT_TRUE(seen_by(Side::kOpponent).ours);
  int in_own_half = 0;
  for (std::size_t i = 0; i < 6; ++i) in_own_half += robot(i).x < 0.0 ? 1 : 0;
  EXPECT_EQ(in_own_half, 2) << "goalkeeper and kicker";
  EXPECT_LT(robot(0).x, -1.0);
}

TEST_F(LeagueGame, TwoAttackersInTheGoalAreaGiveAGoalKick) {
  begin(league_arena());
  put_ball(1.02, 0.2);
  put(1, 1.0, -0.2);
  put(2, 1.0, 0.3);
  wait(0.55);
  ASSERT_EQ(restarts(Restart::kGoalKick), 1U);
  EXPECT_EQ(statistics().fouls, (std::array<std::uint32_t, 2>{1, 0}));
  EXPECT_TRUE(seen_by(Side::kOpponent).ours);
  EXPECT_LT(distance(robot(3), ball()), 0.1) << "the goalkeeper takes it";
  for (const std::size_t own : {0U, 1U, 2U}) EXPECT_LT(robot(own).x, 0.0);
}

TEST_F(LeagueGame, ABallThatStaysInAGoalAreaIsTheGoalkeepersOrTheAttackersFault) {
  begin(league_arena());
  put_ball(-1.02, 0.2);
  wait(2.02);
  EXPECT_EQ(restarts(Restart::kPenalty), 1U) << "the goalkeeper did not clear it";
  wait(kHoldS);
  keep_playing();
  put_ball(-1.02, 0.2);
  put(4, -1.0, -0.25);
  wait(2.02);
  EXPECT_EQ(restarts(Restart::kGoalKick), 1U) << "an attacker stalled there";
  EXPECT_EQ(statistics().fouls, (std::array<std::uint32_t, 2>{1, 1}));
  EXPECT_EQ(restarts(Restart::kFreeBall), 0U);
}

TEST_F(LeagueGame, SidesAreExchangedAfterAHalfAndGoalsCountForTheRightTeam) {
  ArenaParameters parameters = league_arena();
  parameters.rules.half_s = 3.0;
  begin(parameters);
  const GameSituation first = seen_by(Side::kOwn);
  wait(2.0);
  ASSERT_TRUE(game_->rules().sides_exchanged());
  EXPECT_NE(seen_by(Side::kOwn).ours, first.ours) << "the other side kicks off";
  for (const std::size_t own : {0U, 1U, 2U}) EXPECT_GT(robot(own).x, 0.0);
  const std::optional<RefereeState> state = game_->rules().referee();
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->own_on_positive_half, true);
  EXPECT_EQ(state->half, 2);
  wait(0.9);
  put(3, -1.0, 0.6);
  game_->rules().place_ball({-1.0, 0.0, 0.0}, {-1.5, 0.0});
  wait(0.09);
  EXPECT_EQ(statistics().goals_own, 1U);
  EXPECT_EQ(statistics().goals_opponent, 0U);
}

TEST_F(LeagueGame, HalvesOfASimpleGameExchangeSidesToo) {
  ArenaParameters parameters = league_arena();
  parameters.rules.league = League::kSimple;
  parameters.rules.half_s = 2.0;
  begin(parameters);
  wait(1.5);
  EXPECT_TRUE(game_->rules().sides_exchanged());
  EXPECT_NEAR(robot(0).x, 1.0, 1e-9);
  EXPECT_TRUE(game_->rules().is_stopped());
}

TEST_F(LeagueGame, RobotsThatDriveArePlacedOnlyIfTheyAreNotAllowedWhereTheyAre) {
  ArenaParameters parameters = league_arena();
  parameters.rules.robots = RobotsAtRestart::kDrive;
  parameters.rules.line_up_s = 3.0;
  begin(parameters);
  put_ball(0.3, -0.7);
  put(2, 0.5, -0.3);
  wait(2.02);
  ASSERT_EQ(restarts(Restart::kFreeBall), 1U);
  EXPECT_EQ(seen_by(Side::kOwn), (GameSituation{GamePhase::kPrepare, Restart::kFreeBall, false, true}));
  EXPECT_FALSE(game_->rules().is_stopped());
  EXPECT_NEAR(ball().x, 0.55, 1e-9);
  const Vector2 allowed = robot(1);
  keep_playing();
  wait(2.9);
  EXPECT_EQ(seen_by(Side::kOwn).phase, GamePhase::kRunning) << "all robots stand";
  EXPECT_NEAR(distance(robot(1), allowed), 0.0, 0.02);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(distance(robot(i), ball()) >= 0.19) << i;
  }
}

}  // namespace
}  // namespace touchline::hal::mock
